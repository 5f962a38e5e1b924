// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/choose_forgetting.hpp"

#include "tools/evaluation/replay.hpp"
#include "tools/host/host_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace dfdyn::tools {

namespace {

double step_error(const TrainedModel& model, const Recording& recording,
                  const std::function<void(std::size_t)>& on_tick) {
    const auto estimator = make_estimator(model, false);
    const ReplayedRecording replayed = replay(*estimator, {&model, 1}, recording, 0, on_tick);
    const std::size_t outputs = model.outputs.names.size();
    double sum = 0;
    for (std::size_t output = 0; output < outputs; ++output) {
        sum += normalised_error(replayed, outputs, output, 0, replayed.status.size());
    }
    return std::isnan(sum) ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(outputs);
}

} // namespace

double choose_forgetting(const TrainedModel& model, std::span<const double> candidates,
                         const Recording& recording, const std::function<void(double)>& progress) {
    if (candidates.size() == 1) {
        return candidates.front();
    }
    TrainedModel candidate = model;
    std::vector<double> errors;
    for (const double factor : candidates) {
        candidate.forgetting_factor = factor;
        errors.push_back(step_error(candidate, recording, [&](std::size_t ticks) {
            const double share = static_cast<double>(ticks) / static_cast<double>(recording.row_count());
            progress((static_cast<double>(errors.size()) + share) / static_cast<double>(candidates.size()));
        }));
    }
    return candidates[static_cast<std::size_t>(std::ranges::min_element(errors) - errors.begin())];
}

} // namespace dfdyn::tools
