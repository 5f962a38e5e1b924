// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// Quantiles of a distribution for a box plot. NaN without values.
struct Box {
    std::size_t count = 0;
    double low, lower_quartile, median, upper_quartile, high; ///< at 5, 25, 50, 75, 95 %
    double mean;
};

/// Returns the quantiles of `values` without NaN; infinite values are included. O(n log n).
Box box_of(std::vector<double> values);

/// Returns the mean; NaN without values.
double mean_of(std::span<const double> values);

} // namespace dfdyn::tools
