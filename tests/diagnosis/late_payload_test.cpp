// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"

using namespace dfdyn::tests;

TEST_CASE("real residuals that resemble a load for some seconds do not worsen the held-out error") {
    // The first two thirds of this recording, which are fitted, end with four such seconds.
    const CaseScore score = run_panel(203125, 1, PanelMix{}, 1, [](const CaseScore&) {}).front();
    INFO(describe(score));
    REQUIRE(score.noise == "resampled");
    REQUIRE(score.effects.empty());
    REQUIRE(score.harm);
    CHECK(*score.harm < 0.005);
}
