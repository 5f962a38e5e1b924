// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/contradiction.hpp"
#include "tools/common/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr double merged_below_s = 0.25;
constexpr double margin = 3;
constexpr double ordinary_share = 0.999;
constexpr double patience_s = 1;

std::vector<double> settled_innovations(const TrainedModel& model, std::span<const Recording> recordings,
                                        bool from_prior) {
    const auto estimator = make_estimator(model, from_prior);
    std::vector<double> innovations;
    for (const Recording& recording : recordings) {
        const ReplayedRecording replayed = replay(*estimator, {&model, 1}, recording, 0, [](std::size_t) {});
        std::ranges::copy_if(replayed.normalised_innovation_squared, std::back_inserter(innovations),
                             [](float value) { return !std::isnan(value); });
    }
    innovations.erase(innovations.begin(),
                      innovations.begin() + static_cast<std::ptrdiff_t>(innovations.size() / 2));
    return innovations;
}

} // namespace

std::vector<Contradiction> find_contradictions(const ReplayedRecording& replayed, double limit) {
    std::vector<Contradiction> found;
    for (std::size_t tick = 0; tick < replayed.time_s.size(); ++tick) {
        const auto innovation = static_cast<double>(replayed.normalised_innovation_squared[tick]);
        if (!(innovation > limit)) {
            continue;
        }
        const double t = replayed.time_s[tick];
        if (found.empty() || t - found.back().end_s > merged_below_s) {
            found.push_back({t, t, innovation});
        } else {
            found.back().end_s = t;
            found.back().peak = std::max(found.back().peak, innovation);
        }
    }
    std::erase_if(found, [](const Contradiction& one) { return one.end_s <= one.start_s; });
    return found;
}

void calibrate_innovation_limit(TrainedModel& model, std::span<const Recording> recordings, bool from_prior) {
    model.limits.innovation = std::numeric_limits<float>::max();
    model.limits.innovation_patience = static_cast<int>(std::ceil(patience_s / model.sample_period_s));
    const std::vector<double> innovations = settled_innovations(model, recordings, from_prior);
    if (!innovations.empty()) {
        model.limits.innovation = margin * quantile(innovations, ordinary_share);
    }
}

} // namespace dfdyn::tools
