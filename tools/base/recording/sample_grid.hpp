// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Largest relative deviation of a sample period that SampleClock follows.
inline constexpr double followed_deviation = 0.125;

/// Returns the sample period (s) of recordings from one sender: the mean of the steps without a loss. If the
/// median of all steps is within 1 % of the mean, returns the median, which is exact for a steady clock.
/// Throws InputError for fewer than two rows, and if the period of a recording differs from that of the
/// first one by more than `followed_deviation`.
double sample_period_s(std::span<const Recording> recordings);

/// Throws InputError if the rows of `recording` are closer than a model's sample period by more than
/// `followed_deviation`. The estimator does not detect this; rows too far apart it treats as gaps. `model`:
/// named in the message.
void check_not_faster(const Recording& recording, double period_s, const std::string& model);

/// Throws InputError, in addition, if the rows are farther apart by more than `followed_deviation`.
void check_period(const Recording& recording, double period_s, const std::string& model);

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
