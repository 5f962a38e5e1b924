// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace dfdyn::tools {

/// Noise added to every row of a recording, optionally correlated between rows.
struct OutputNoiseModel {
    JointVector torque;             ///< N·m, standard deviation; empty: none
    Wrench wrench = Wrench::Zero(); ///< standard deviation
    double coefficient = 0;         ///< 0: white; below 1: first-order autoregression between rows
    std::vector<double> series;   ///< if given: random pieces of this signal, scaled to standard deviation 1
    std::size_t piece_rows = 256; ///< length of a piece
};

/// One noise signal with standard deviation 1 and mean 0.
class UnitNoise {
  public:
    /// Different channels of a seed are independent.
    UnitNoise(const OutputNoiseModel& model, std::uint64_t seed, std::uint32_t channel);

    double next();

  private:
    double resampled();
    std::size_t start_of_piece();

    double coefficient_;
    std::vector<double> series_;
    std::size_t piece_rows_, overlap_rows_;
    NormalSource source_;
    std::mt19937_64 engine_;
    double value_ = 0;
    std::size_t row_ = 0, piece_ = 0, past_piece_ = 0;
};

/// The noise of all outputs of a recording.
class OutputNoise {
  public:
    OutputNoise(const OutputNoiseModel& model, std::uint64_t seed);

    /// Returns the torque noise of one row. Call each function once per row.
    JointVector torque();
    Wrench wrench();

  private:
    OutputNoiseModel model_;
    std::vector<UnitNoise> joints_, axes_;
};

} // namespace dfdyn::tools
