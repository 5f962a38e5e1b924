// SPDX-License-Identifier: Apache-2.0
// Arms that have friction at every joint.
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <algorithm>

using namespace dfdyn::tests;

namespace {

CaseScore score_of(std::uint64_t seed) {
    PanelMix mix;
    mix.robot = unknown_arm;
    std::vector<CaseScore> scores = run_panel(seed, 1, mix, 1, [](const CaseScore&) {});
    REQUIRE(scores.size() == 1);
    return scores.front();
}

bool is_friction(const FindingScore& finding) {
    const dfdyn::tools::Effect* const effect = dfdyn::tools::find_effect(finding.effect);
    return effect != nullptr && effect->friction;
}

} // namespace

TEST_CASE("Coulomb friction is named or listed as indistinguishable where another kind is hardly better") {
    const CaseScore score =
        score_of(500018); // Stribeck friction was named at joints 1 and 2, with 0.99 and 0.94
    INFO(describe(score));
    CHECK(std::ranges::count_if(score.findings, is_friction) >= 5);
    for (const FindingScore& finding : score.findings) {
        CHECK((finding.right || !is_friction(finding) || finding.confidence < 0.5));
    }
}
