// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/common_ticks.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/experiment/synthetic_jobs.hpp"

#include <cmath>
#include <limits>

namespace common_ticks_test {

using namespace dfdyn::tools;
using dfdyn::tests::job_at;
using dfdyn::tests::two_case_plan;

constexpr std::size_t rows = 60;
constexpr std::size_t horizon = 5;
const double infinite = std::numeric_limits<double>::infinity();

/// A plan with windows of 4 and of 7 lags whose outputs are never 0.
Plan plan_with_windows() {
    Plan plan = two_case_plan(1);
    plan.horizon = horizon;
    plan.cases[0].lags = 4;
    plan.cases[1].lags = 7;
    return plan;
}

PlanData data_of_three_subsets() {
    PlanData data;
    data.group_outputs = {{0}, {1}};
    Recording subset;
    subset.output = {{"fx", "mx"}, std::vector<double>(2 * rows, 1.0)};
    subset.time_s.resize(rows);
    subset.time_ns.resize(rows);
    subset.gap_before.resize(rows);
    subset.gap_before[0] = 1;
    data.subsets.assign(3, subset);
    return data;
}

std::vector<bool> ticks_from_to(std::size_t first, std::size_t last) {
    std::vector<bool> ticks(rows, false);
    std::fill(ticks.begin() + static_cast<std::ptrdiff_t>(first),
              ticks.begin() + static_cast<std::ptrdiff_t>(last), true);
    return ticks;
}

TEST_CASE("ticks are scored after the largest window until the last complete horizon") {
    CHECK(common_ticks(plan_with_windows(), data_of_three_subsets(), 0, 1) ==
          ticks_from_to(7, rows - horizon));
}

TEST_CASE("a gap restarts the window and no horizon extends across it") {
    PlanData data = data_of_three_subsets();
    data.subsets[1].gap_before[30] = 1;
    std::vector<bool> expected = ticks_from_to(7, 30 - horizon);
    std::fill(expected.begin() + 30 + 7, expected.end() - horizon, true);
    CHECK(common_ticks(plan_with_windows(), data, 0, 1) == expected);
    CHECK(common_ticks(plan_with_windows(), data, 0, 0) == ticks_from_to(7, rows - horizon));
}

TEST_CASE("a subset shorter than window and horizon has no common ticks") {
    Plan plan = plan_with_windows();
    plan.horizon = rows;
    CHECK(common_ticks(plan, data_of_three_subsets(), 0, 0) == std::vector<bool>(rows, false));
}

TEST_CASE("ticks without a relative error because an output is zero are not scored") {
    Plan plan = plan_with_windows();
    PlanData data = data_of_three_subsets();
    for (std::size_t row = 20; row < 28; ++row) {
        data.subsets[0].output.values[2 * row + 1] = 0;
    }
    std::vector<bool> expected = ticks_from_to(7, rows - horizon);
    expected[19] = expected[20] = expected[21] = expected[22] = false; // an output is 0 at the next five rows
    CHECK(common_ticks(plan, data, 1, 0) == expected);
    CHECK(common_ticks(plan, data, 0, 0) == ticks_from_to(7, rows - horizon));
    plan.error_scale = ErrorScale::variance;
    CHECK(common_ticks(plan, data, 1, 0) == ticks_from_to(7, rows - horizon));
}

TEST_CASE("errors of other ticks are dropped and missing errors of common ticks are infinite") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<JobResult> jobs{job_at("A", 1, 1, engine), job_at("B", 1, 1, engine)};
    jobs[0].error[1][2][6] = 0.5;
    jobs[0].error[1][2][9] = std::nan("");
    jobs[1].error[0][1][8] = infinite;
    const std::vector<JobResult> before = jobs;
    keep_common_ticks(plan_with_windows(), data_of_three_subsets(), jobs);
    for (std::size_t job = 0; job < 2; ++job) {
        for (std::size_t tick = 0; tick < rows; ++tick) {
            for (std::size_t group = 0; group < 2; ++group) {
                CAPTURE(job, group, tick);
                const bool common = tick >= 7 && tick < rows - horizon;
                const double error = jobs[job].error[group][2][tick];
                CHECK(std::isnan(error) == !common);
                if (common && !(job == 0 && group == 1 && tick == 9)) {
                    CHECK(error == before[job].error[group][2][tick]);
                }
            }
        }
    }
    CHECK(jobs[0].error[1][2][9] == infinite);
    CHECK(jobs[1].error[0][1][8] == infinite);
}

} // namespace common_ticks_test
