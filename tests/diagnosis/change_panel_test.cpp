// SPDX-License-Identifier: Apache-2.0
// Changes hidden in simulated arms, found by the monitor of the learner. The panel has many more cases.
#include "tests/diagnosis/panel/changes/change_panel.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>

namespace {

using namespace dfdyn::tests;

int count(const std::vector<ChangeScore>& scores, bool (*holds)(const ChangeScore&)) {
    return static_cast<int>(std::ranges::count_if(scores, holds));
}

} // namespace

// The limits are minimums for these seeds; docs/guide/monitor.md has the rates over many more cases.
TEST_CASE("most changes hidden in simulated arms are found with their cause and place", "[changes]") {
    ChangeMix mix;
    mix.duration_s = 82;
    std::string all;
    const std::vector<ChangeScore> scores =
        run_change_panel(600, 15, mix, [&all](const ChangeScore& one) { all += describe(one) + '\n'; });
    INFO(all);
    CHECK(count(scores, [](const ChangeScore& one) { return one.hit != nullptr; }) >= 12);
    CHECK(count(scores, [](const ChangeScore& one) { return one.right_cause(); }) >= 11);
    CHECK(count(scores, [](const ChangeScore& one) { return one.right_place(); }) >= 10);
    CHECK(count(scores, [](const ChangeScore& one) { return one.false_alarms > 0; }) == 0);
}

TEST_CASE("the monitor raises no alarm if nothing changes in a simulated arm", "[changes]") {
    ChangeMix mix;
    mix.never = true;
    mix.duration_s = 120;
    for (const std::string& robot : change_robot_names()) {
        mix.robot = robot;
        const ChangeScore score = run_change_panel(300, 1, mix, [](const ChangeScore&) {}).front();
        INFO(describe(score));
        CHECK(score.found.empty());
    }
}
