// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/experiment/plan/plan.hpp"
#include "tools/experiment/run/job_result.hpp"

#include <random>

namespace dfdyn::tests {

/// A plan of two cases, A and B, and two groups, without files. It is steady after 2 s.
inline tools::Plan two_case_plan(std::size_t draws) {
    tools::Plan plan;
    plan.name = std::string("plan");
    plan.title = std::string("A against B");
    plan.training_log = "train.csv";
    plan.steady_after_s = 2;
    plan.groups = {{"force", {"fx"}}, {"torque", {"mx"}}};
    plan.cases.resize(2);
    plan.cases[0].name = std::string("A");
    plan.cases[1].name = std::string("B");
    for (std::size_t seed = 1; seed <= draws; ++seed) {
        plan.seeds.push_back(seed);
    }
    plan.figures = {{"Both", {"A", "B"}}};
    return plan;
}

/// A job with random errors about `level`, every 0.1 s, in three subsets of 60 ticks.
inline tools::JobResult job_at(const std::string& name, std::uint64_t seed, double level,
                               std::mt19937_64& engine) {
    std::lognormal_distribution<double> spread(0, 0.1);
    tools::JobResult job{name, seed, 0.1, {}, {0.1 * level, 0.2 * level}, 3.5, 1000, 4000, 20};
    job.error.resize(2);
    for (auto& group : job.error) {
        group.resize(3);
        for (std::vector<double>& subset : group) {
            for (int tick = 0; tick < 60; ++tick) {
                subset.push_back(level * spread(engine));
            }
        }
    }
    return job;
}

} // namespace dfdyn::tests
