// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"

using namespace dfdyn::tests;

namespace {

std::vector<CaseScore> wrenches_in_white_noise(PanelMix mix) {
    mix.two_effects_share = mix.outside_share = 0;
    mix.robot = "icub_wrench"; // only four bodies are beyond its sensor
    mix.noise = "white";
    return run_panel(101601, 8, mix, 1, [](const CaseScore&) {});
}

} // namespace

TEST_CASE("a single wrong link in an otherwise exact file is named although all masses could be uncertain") {
    PanelMix mix;
    mix.null_share = 0;
    mix.effect = "link_inertia_error";
    mix.masses_off = false;
    mix.strength = 10;
    for (const CaseScore& score : wrenches_in_white_noise(mix)) {
        INFO(describe(score));
        REQUIRE(score.effects.size() == 1);
        REQUIRE(score.effects.front().named);
        REQUIRE(score.effects.front().relative_error);
        CHECK(*score.effects.front().relative_error < 0.2);
        CHECK(score.effects.front().in_interval);
    }
}

TEST_CASE("small errors of all masses make no single link likely") {
    PanelMix mix;
    mix.null_share = 1;
    mix.masses_off = true;
    for (const CaseScore& score : wrenches_in_white_noise(mix)) {
        INFO(describe(score));
        for (const FindingScore& finding : score.findings) {
            CHECK(finding.confidence < 0.5);
        }
    }
}
