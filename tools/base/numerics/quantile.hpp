// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace dfdyn::tools {

/// The quantile of a sample by linear interpolation between neighbours: of `ascending` values the one at
/// place share (count - 1), counted from 0. 0 <= share <= 1: 0 gives the least, 1 the largest, 0.5 the
/// median. NaN for no values at all.
double quantile_of_sorted(std::span<const double> ascending, double share);

/// The same of values in any order, none of them NaN. O(count).
double quantile(std::vector<double> values, double share);

/// quantile(values, 0.5).
double median(std::vector<double> values);

/// Standard deviation of a Gaussian over the median of its magnitude.
inline constexpr double median_to_deviation = 1.4826;

} // namespace dfdyn::tools
