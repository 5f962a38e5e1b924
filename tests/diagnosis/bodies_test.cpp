// SPDX-License-Identifier: Apache-2.0
// Loads and links, wrong or not.
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

TEST_CASE("real residuals that resemble a load for some seconds do not worsen the held-out error") {
    // The first two thirds of this recording, which are fitted, end with four such seconds.
    const CaseScore score = run_panel(203125, 1, PanelMix{}, 1, [](const CaseScore&) {}).front();
    INFO(describe(score));
    REQUIRE(score.noise == "resampled");
    REQUIRE(score.effects.empty());
    REQUIRE(score.harm);
    CHECK(*score.harm < 0.005);
}
