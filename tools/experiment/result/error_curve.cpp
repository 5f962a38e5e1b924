// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/error_curve.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/experiment/result/box.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace dfdyn::tools {

namespace {

/// Returns the mean over the subsets with a value at the tick; NaN if there is none.
double subset_mean(const JobResult& draw, std::size_t group, std::size_t tick) {
    std::vector<double> values;
    for (const std::vector<double>& subset : draw.error[group]) {
        if (tick < subset.size() && !std::isnan(subset[tick])) {
            values.push_back(subset[tick]);
        }
    }
    return mean_of(values);
}

std::size_t longest_subset(const JobResult& draw, std::size_t group) {
    std::size_t longest = 0;
    for (const std::vector<double>& subset : draw.error[group]) {
        longest = std::max(longest, subset.size());
    }
    return longest;
}

} // namespace

ErrorCurve error_curve(std::span<const JobResult* const> draws, std::size_t group) {
    ErrorCurve curve;
    const std::size_t ticks = draws.empty() ? 0 : longest_subset(*draws.front(), group);
    for (std::size_t tick = 0; tick < ticks; ++tick) {
        std::vector<double> means;
        for (const JobResult* draw : draws) {
            means.push_back(subset_mean(*draw, group, tick));
        }
        std::ranges::sort(means);
        curve.time_s.push_back(static_cast<double>(tick) * draws.front()->sample_period_s);
        curve.mean.push_back(mean_of(means));
        curve.low.push_back(quantile_of_sorted(means, 0.25));
        curve.high.push_back(quantile_of_sorted(means, 0.75));
    }
    return curve;
}

ErrorCurve thinned(const ErrorCurve& curve, int per_decade) {
    std::map<long, std::vector<std::size_t>> stretches;
    for (std::size_t tick = 0; tick < curve.time_s.size(); ++tick) {
        if (curve.time_s[tick] > 0 && !std::isnan(curve.mean[tick])) {
            stretches[std::lround(std::floor(std::log10(curve.time_s[tick]) * per_decade))].push_back(tick);
        }
    }
    ErrorCurve thin;
    for (const auto& [stretch, ticks] : stretches) {
        const auto mean = [&ticks = ticks](const std::vector<double>& values) {
            std::vector<double> chosen;
            std::ranges::transform(ticks, std::back_inserter(chosen),
                                   [&](std::size_t i) { return values[i]; });
            return mean_of(chosen);
        };
        thin.time_s.push_back(mean(curve.time_s));
        thin.mean.push_back(mean(curve.mean));
        thin.low.push_back(mean(curve.low));
        thin.high.push_back(mean(curve.high));
    }
    return thin;
}

} // namespace dfdyn::tools
