// SPDX-License-Identifier: Apache-2.0
// Changes hidden in simulated arms, found by the monitor of what learns them; the panel has many more.
#include "tests/diagnosis/change_panel.hpp"

#include "tests/support/catch.hpp"

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

ChangeScore run_one(std::uint64_t seed, const ChangeMix& mix) {
    return run_change_panel(seed, 1, mix, [](const ChangeScore&) {}).front();
}

} // namespace

TEST_CASE("A change hidden in a simulated arm is found, named and placed", "[changes]") {
    // of the panel's seeds from 100: one of each cause, fixed, so that it costs seconds
    const auto [seed, robot] = GENERATE(table<std::uint64_t, std::string>({{105, "icub_wrench"},
                                                                           {111, "icub_wrench"},
                                                                           {113, "icub_wrench"},
                                                                           {121, "icub_wrench"},
                                                                           {117, "ur5_torque"}}));
    ChangeMix mix;
    mix.robot = robot;
    const ChangeScore score = run_one(seed, mix);
    INFO(describe(score));
    CHECK(score.false_alarms == 0);
    REQUIRE(score.hit != nullptr);
    CHECK(score.delay_s < 3);
    CHECK(score.right_cause());
    CHECK(score.right_place());
    CHECK(score.hit->confidence > 0.6);
}

TEST_CASE("Where nothing changes in a simulated arm the monitor is silent", "[changes]") {
    ChangeMix mix;
    mix.robot = "icub_wrench";
    mix.never = true;
    const ChangeScore score = run_one(300, mix);
    INFO(describe(score));
    CHECK(score.found.empty());
}
