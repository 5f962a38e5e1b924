// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/training/data/training_data.hpp"

#include <span>

namespace dfdyn::tools {

/// Returns the samples of `recordings`, in order, with their sample_period_s(). Gaps are those of
/// window_restarts(). Throws InputError if there are fewer than two rows. All recordings must have the same
/// columns (as guaranteed by `read_recordings`).
TrainingData gather_training_data(std::span<const Recording> recordings);

/// Copies velocities and accelerations from the recordings' columns, which must exist.
void copy_derivatives(TrainingData& data, std::span<const Recording> recordings);

/// Returns a bound of the position noise (rad) for the adaptive window of input STD: three times the noise
/// standard deviation, estimated from third differences of the positions; the largest over the joints, at
/// least 1e-6.
double estimate_position_noise_bound(const TrainingData& data);

/// Estimates velocities and accelerations with the firmware's adaptive window over at most `lags` + 1
/// positions. O(T n lags^2).
void estimate_derivatives(TrainingData& data, std::span<const Recording> recordings, int lags,
                          double position_noise_bound);

} // namespace dfdyn::tools
