// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/phase_error.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

std::vector<double> errors_of_phase(const JobResult& job, std::size_t group, std::size_t subset, Phase phase,
                                    double steady_after_s) {
    const std::vector<double>& error = job.error[group][subset];
    std::vector<double> values;
    for (std::size_t tick = 0; tick < error.size(); ++tick) {
        const bool steady = static_cast<double>(tick) * job.sample_period_s >= steady_after_s;
        if (steady == (phase == Phase::steady) && !std::isnan(error[tick])) {
            values.push_back(error[tick]);
        }
    }
    return values;
}

double phase_error(const JobResult& job, std::size_t group, std::size_t subset, Phase phase,
                   double steady_after_s) {
    const Box box = box_of(errors_of_phase(job, group, subset, phase, steady_after_s));
    return phase == Phase::transient ? box.mean : box.median;
}

double lost_share(std::span<const JobResult* const> draws, std::size_t group) {
    double scored = 0;
    double lost = 0;
    for (const JobResult* draw : draws) {
        for (const std::vector<double>& subset : draw->error[group]) {
            for (const double error : subset) {
                scored += std::isnan(error) ? 0 : 1;
                lost += std::isinf(error) ? 1 : 0;
            }
        }
    }
    return scored > 0 ? lost / scored : 0;
}

Box phase_box(std::span<const JobResult* const> draws, std::size_t group, Phase phase,
              double steady_after_s) {
    std::vector<double> all;
    for (const JobResult* draw : draws) {
        for (std::size_t subset = 0; subset < draw->error[group].size(); ++subset) {
            std::ranges::copy(errors_of_phase(*draw, group, subset, phase, steady_after_s),
                              std::back_inserter(all));
        }
    }
    return box_of(std::move(all));
}

} // namespace dfdyn::tools
