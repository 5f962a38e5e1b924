// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the sample period (s) of recordings from one sender: the mean of the steps without a loss. If the
/// median of all steps is within 1 % of the mean, returns the median, which is exact for a steady clock.
/// Throws InputError for fewer than two rows.
double sample_period_s(std::span<const Recording> recordings);

/// Returns, for each row, 1 if the estimator will restart its window there: at the first row, at rows marked
/// by the recording, and after a loss detected by the firmware's SampleClock.
std::vector<std::uint8_t> window_restarts(const Recording& recording, double period_s);

} // namespace dfdyn::tools
