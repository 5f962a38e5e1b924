// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/run_panel.hpp"
#include "tests/support/catch.hpp"

using namespace dfdyn::tests;

TEST_CASE(
    "the one link that is off in an otherwise exact file is named, though masses could all be uncertain") {
    PanelMix mix;
    mix.null_share = mix.two_effects_share = mix.outside_share = 0;
    mix.effect = "link_inertia_error";
    mix.robot = "icub_wrench"; // behind its sensor there are four bodies only
    mix.noise = "white";
    mix.masses_off = false;
    mix.strength = 10;
    for (const int seed : {101601, 101602, 101605, 101608}) {
        const CaseScore score = run_panel(seed, 1, mix, 1, [](const CaseScore&) {}).front();
        INFO(describe(score));
        REQUIRE(score.effects.size() == 1);
        REQUIRE(score.effects.front().named);
        REQUIRE(score.effects.front().relative_error);
        CHECK(*score.effects.front().relative_error < 0.2);
        CHECK(score.effects.front().in_interval);
    }
}
