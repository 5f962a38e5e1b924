// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The sample period (s) of recordings made by one sender: the mean of the steps that have no loss in
/// between; the median of all steps where it is within 1 % of that, because it is exact for a steady clock.
/// Throws InputError for fewer than two rows.
double sample_period_s(std::span<const Recording> recordings);

/// For each row, 1 if the estimator will restart its window there: the first row, rows that the recording
/// marks, and rows before which the firmware's SampleClock sees a loss.
std::vector<std::uint8_t> window_restarts(const Recording& recording, double period_s);

} // namespace dfdyn::tools
