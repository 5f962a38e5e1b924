// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// How long one kind of tick took, µs each.
struct TickTimes {
    std::size_t ticks = 0; ///< that count
    double median = 0, p90 = 0, p99 = 0, p999 = 0, most = 0;
    double spread = 0;   ///< distance of the quartiles, as a share of the median
    double accepted = 0; ///< share of the repetitions during which the machine was undisturbed
};

/// Of the ticks' times in µs; all zero for none.
TickTimes summarise(std::vector<double> times_us, double accepted_share);

/// The exponent e of the power law time = c · size^e with the least squared error of the logarithms. At least
/// two sizes, all numbers positive.
double fitted_exponent(std::span<const double> sizes, std::span<const double> times);

} // namespace dfdyn::tools
