// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/common_ticks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

/// Returns whether `output` is 0 in the rows first … last - 1.
bool rests_at_zero(const Recording& recording, std::size_t output, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
        if (recording.output.row(row)[output] != 0) {
            return false;
        }
    }
    return true;
}

void keep(const std::vector<bool>& common, std::vector<double>& error) {
    for (std::size_t tick = 0; tick < error.size(); ++tick) {
        if (!common[tick]) {
            error[tick] = std::numeric_limits<double>::quiet_NaN();
        } else if (!std::isfinite(error[tick])) {
            error[tick] = std::numeric_limits<double>::infinity();
        }
    }
}

} // namespace

std::size_t largest_window(const Plan& plan) {
    int most = 0;
    for (const Case& one : plan.cases) {
        most = std::max(most, one.lags);
    }
    return static_cast<std::size_t>(most);
}

std::vector<bool> common_ticks(const Plan& plan, const PlanData& data, std::size_t group,
                               std::size_t subset) {
    const Recording& recording = data.subsets[subset];
    const std::size_t lags = largest_window(plan);
    std::vector<bool> common(recording.row_count(), false);
    std::size_t start = 0; // first row of the interval without a gap that reaches the horizon's end
    for (std::size_t end = 0; end < recording.row_count(); ++end) {
        start = recording.gap_before[end] != 0 ? end : start;
        if (end < start + lags + plan.horizon) {
            continue;
        }
        const std::size_t tick = end - plan.horizon;
        common[tick] = plan.error_scale != ErrorScale::horizon ||
                       std::ranges::none_of(data.group_outputs[group], [&](std::size_t output) {
                           return rests_at_zero(recording, output, tick + 1, end + 1);
                       });
    }
    return common;
}

void keep_common_ticks(const Plan& plan, const PlanData& data, std::span<JobResult> jobs) {
    for (std::size_t group = 0; group < plan.groups.size(); ++group) {
        for (std::size_t subset = 0; subset < data.subsets.size(); ++subset) {
            const std::vector<bool> common = common_ticks(plan, data, group, subset);
            for (JobResult& job : jobs) {
                keep(common, job.error[group][subset]);
            }
        }
    }
}

} // namespace dfdyn::tools
