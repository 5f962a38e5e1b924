// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Rows that follow each other without a gap.
struct Stretch {
    Eigen::Index first = 0, count = 0;
};

/// Of the steps between rows, by their stamps; NaN for less than two rows.
double median_step_s(const Recording& recording);

/// The rows of a recording, parted at gaps: those that it marks, and steps above three times the median.
std::vector<Stretch> recorded_stretches(const Recording& recording);

} // namespace dfdyn::tools
