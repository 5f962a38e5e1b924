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

/// A number of rows from one to the next with which a recording has constant time steps.
struct SteadyStride {
    std::size_t rows = 0; ///< from 2; 0: there is none up to 8
    double period_s = 0;
};

/// Returns the smallest stride with which at least 97 % of the time steps are within 10 % of their median. A
/// recorder that writes pairs, with steps of 8 and 24 ms in turn, has one of 2 rows.
SteadyStride steady_stride(std::span<const Recording> recordings);

/// Returns, for each row, 1 if the estimator will restart its window there: at the first row, at rows marked
/// by the recording, and after a loss detected by the firmware's SampleClock.
std::vector<std::uint8_t> window_restarts(const Recording& recording, double period_s);

} // namespace dfdyn::tools
