// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/box.hpp"

#include "tools/base/numerics/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dfdyn::tools {

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Box box_of(std::vector<double> values) {
    std::erase_if(values, [](double value) { return std::isnan(value); });
    std::ranges::sort(values);
    const auto at = [&values](double share) { return quantile_of_sorted(values, share); };
    return {values.size(), at(0.05), at(0.25), at(0.5), at(0.75), at(0.95), mean_of(values)};
}

} // namespace dfdyn::tools
