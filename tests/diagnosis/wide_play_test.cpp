// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"

#include <utility>

using namespace dfdyn::tests;

TEST_CASE("backlash is named with its gap even if the impact is not the whole joint's") {
    for (const auto& [robot, seed] :
         {std::pair{"three_joint_torque", 101600}, std::pair{"ur5_torque", 101604}}) {
        PanelMix mix;
        mix.null_share = mix.two_effects_share = mix.outside_share = 0;
        mix.effect = "backlash";
        mix.robot = robot;
        const CaseScore score = run_panel(seed, 1, mix, 1, [](const CaseScore&) {}).front();
        INFO(describe(score));
        REQUIRE(score.effects.size() == 1);
        const EffectScore& play = score.effects.front();
        CHECK(play.strength > 3);
        REQUIRE(play.named);
        CHECK(play.relative_error < 0.2);
        CHECK(play.in_interval);
    }
}
