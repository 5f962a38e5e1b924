// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/training/data/training_data.hpp"

#include <span>

namespace dfdyn::tools {

/// The samples of `recordings`, in order, with their sample_period_s(); a row follows a gap where
/// window_restarts() says so. Throws InputError when there are fewer than two rows. All recordings have the
/// same columns (as `read_recordings` sees to).
TrainingData gather_training_data(std::span<const Recording> recordings);

/// Fills velocities and accelerations from the recordings' columns, which they must have.
void copy_derivatives(TrainingData& data, std::span<const Recording> recordings);

/// A bound of the positions' noise (rad) for the adaptive window of input STD: three times the standard
/// deviation of what third differences of the positions leave, the largest over the joints, and not below
/// 1e-6.
double estimate_position_noise_bound(const TrainingData& data);

/// Fills velocities and accelerations by the firmware's own adaptive window over at most `lags` + 1
/// positions.
void estimate_derivatives(TrainingData& data, std::span<const Recording> recordings, int lags,
                          double position_noise_bound);

} // namespace dfdyn::tools
