// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace dfdyn::tools {

double interpolated_quantile(std::span<const double> ascending, double share) {
    if (ascending.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    const double place = share * static_cast<double>(ascending.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, ascending.size() - 1);
    const double part = place - static_cast<double>(below);
    if (part == 0 || ascending[below] == ascending[above]) { // also where both are infinite
        return ascending[below];
    }
    return ascending[below] + part * (ascending[above] - ascending[below]);
}

double median_of(std::vector<double> values) {
    std::ranges::sort(values);
    return interpolated_quantile(values, 0.5);
}

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Box box_of(std::vector<double> values) {
    std::erase_if(values, [](double value) { return std::isnan(value); });
    std::ranges::sort(values);
    const auto at = [&values](double share) { return interpolated_quantile(values, share); };
    return {values.size(), at(0.05), at(0.25), at(0.5), at(0.75), at(0.95), mean_of(values)};
}

} // namespace dfdyn::tools
