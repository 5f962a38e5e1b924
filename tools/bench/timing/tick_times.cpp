// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/tick_times.hpp"

#include "tools/base/numerics/quantile.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

TickTimes summarise(std::vector<double> times_us, double accepted_share) {
    TickTimes result;
    result.ticks = times_us.size();
    result.accepted = accepted_share;
    if (times_us.empty()) {
        return result;
    }
    std::ranges::sort(times_us);
    result.median = quantile_of_sorted(times_us, 0.5);
    result.p90 = quantile_of_sorted(times_us, 0.9);
    result.p99 = quantile_of_sorted(times_us, 0.99);
    result.p999 = quantile_of_sorted(times_us, 0.999);
    result.p9999 = quantile_of_sorted(times_us, 0.9999);
    result.most = times_us.back();
    result.spread = (quantile_of_sorted(times_us, 0.75) - quantile_of_sorted(times_us, 0.25)) / result.median;
    return result;
}

double fitted_exponent(std::span<const double> sizes, std::span<const double> times) {
    double mean_x = 0;
    double mean_y = 0;
    const auto count = static_cast<double>(sizes.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        mean_x += std::log(sizes[i]) / count;
        mean_y += std::log(times[i]) / count;
    }
    double xx = 0;
    double xy = 0;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const double x = std::log(sizes[i]) - mean_x;
        xx += x * x;
        xy += x * (std::log(times[i]) - mean_y);
    }
    return xy / xx;
}

} // namespace dfdyn::tools
