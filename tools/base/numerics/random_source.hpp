// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <random>

namespace dfdyn::tools {

/// Standard normal numbers that are the same with every standard library: the 64-bit Mersenne twister is
/// specified exactly, std::normal_distribution is not, so the transform (Box and Muller's) is our own.
class NormalSource {
  public:
    /// Different `stream`s of one seed are independent.
    explicit NormalSource(std::uint64_t seed, std::uint32_t stream = 0);

    double next();

    /// Filled row by row.
    Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns);

  private:
    double uniform(); // in (0, 1]

    std::mt19937_64 engine_;
    double spare_ = 0;
    bool has_spare_ = false;
};

} // namespace dfdyn::tools
