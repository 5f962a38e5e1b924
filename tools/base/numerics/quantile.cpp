// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Interpolates between neighbours, one or both of which may be infinite.
double between(double below, double above, double part) {
    return part == 0 || below == above ? below : std::lerp(below, above, part);
}

} // namespace

double quantile_of_sorted(std::span<const double> ascending, double share) {
    if (ascending.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double place = share * static_cast<double>(ascending.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, ascending.size() - 1);
    return between(ascending[below], ascending[above], place - static_cast<double>(below));
}

double quantile(std::vector<double> values, double share) {
    if (values.empty()) {
        return quantile_of_sorted(values, share);
    }
    const auto below = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    const auto middle = values.begin() + below;
    std::ranges::nth_element(values, middle);
    if (middle + 1 != values.end()) {
        std::iter_swap(middle + 1, std::min_element(middle + 1, values.end()));
    }
    return between(*middle, middle + 1 == values.end() ? *middle : middle[1],
                   share * static_cast<double>(values.size() - 1) - static_cast<double>(below));
}

double mean_square_quantile(std::size_t count, double normal_quantile) {
    const double part = 2.0 / (9 * static_cast<double>(count));
    return std::pow(1 - part + normal_quantile * std::sqrt(part), 3);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

} // namespace dfdyn::tools
