// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Returns a quantile of a sample by linear interpolation between neighbours: the value at position share
/// (count - 1), counted from 0, of `ascending`. 0 <= share <= 1: 0 gives the minimum, 1 the maximum, 0.5 the
/// median. NaN for an empty sample.
double quantile_of_sorted(std::span<const double> ascending, double share);

/// Returns the quantile of values in any order, without NaN. O(count).
double quantile(std::vector<double> values, double share);

/// Returns quantile(values, 0.5).
double median(std::vector<double> values);

/// Returns the quantile of the mean of `count` >= 1 squared independent standard normal values (chi-square /
/// count) at the share below `normal_quantile` of a standard normal value, by the approximation of E. B.
/// Wilson and M. M. Hilferty (1931): from 10 to 99.9 %, the smaller of share and 1 - share is within 15 % for
/// count >= 2. For count 1 the 99.9 % quantile is 3 % too large, and the 10 % quantile that of 6 %.
double mean_square_quantile(std::size_t count, double normal_quantile);

/// Ratio of a Gaussian's standard deviation to the median of its magnitude.
inline constexpr double median_to_deviation = 1.4826;

} // namespace dfdyn::tools
