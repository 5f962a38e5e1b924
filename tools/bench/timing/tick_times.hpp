// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Quantiles of times of one kind of tick, µs each.
struct TickTimes {
    std::size_t ticks = 0; ///< number of valid ticks
    double median = 0, p90 = 0, p99 = 0, p999 = 0, p9999 = 0, most = 0;
    double spread = 0;   ///< interquartile range relative to the median
    double accepted = 0; ///< share of valid repetitions
};

/// Summarizes times in µs; all zero without times.
TickTimes summarise(std::vector<double> times_us, double accepted_share);

/// Returns the exponent e of the power law time = c · size^e by least squares of the logarithms. Requires at
/// least two sizes and positive numbers.
double fitted_exponent(std::span<const double> sizes, std::span<const double> times);

} // namespace dfdyn::tools
