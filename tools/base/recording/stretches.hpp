// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Consecutive rows without a gap.
struct Stretch {
    Eigen::Index first = 0, count = 0;
};

/// Returns the time (s) from the row before `row` to `row`, which is at least 1.
double time_step_s(const Recording& recording, std::size_t row);

/// Returns the median of the time steps between rows; NaN for less than two rows.
double median_step_s(const Recording& recording);

/// Returns the rows of a recording, divided at gaps: those marked by the recording, and steps longer than
/// three times the median.
std::vector<Stretch> recorded_stretches(const Recording& recording);

} // namespace dfdyn::tools
