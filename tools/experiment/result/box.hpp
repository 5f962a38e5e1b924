// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace dfdyn::tools {

/// What a box plot shows of a distribution. NaN where there are no values.
struct Box {
    std::size_t count = 0;
    double low, lower_quartile, median, upper_quartile, high; ///< at 5, 25, 50, 75, 95 %
    double mean;
};

/// Of `values` without the NaN; an infinite one counts like any other. O(n log n).
Box box_of(std::vector<double> values);

/// NaN without values.
double mean_of(std::span<const double> values);

} // namespace dfdyn::tools
