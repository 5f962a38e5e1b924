// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <random>

namespace dfdyn::tools {

/// Standard normal numbers that are equal with every standard library. The 64-bit Mersenne twister is
/// specified exactly, but std::normal_distribution is not; therefore this class implements the Box–Muller
/// transform.
class NormalSource {
  public:
    /// Different streams of one seed are independent.
    explicit NormalSource(std::uint64_t seed, std::uint32_t stream = 0);

    double next();

    /// Returns a matrix that is filled row by row.
    Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index columns);

  private:
    double uniform(); // in (0, 1]

    std::mt19937_64 engine_;
    double spare_ = 0;
    bool has_spare_ = false;
};

} // namespace dfdyn::tools
