// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"

#include <cstdint>
#include <utility>
#include <vector>

using namespace dfdyn::tests;

namespace {

/// Requires the backlash, the first of the effects hidden in a recording, to be named with its gap.
void check_named(const PanelMix& mix, std::uint64_t seed, std::size_t effects, double least_strength) {
    const std::vector<CaseScore> scores = run_panel(seed, 1, mix, 1, [](const CaseScore&) {});
    REQUIRE(scores.size() == 1);
    INFO(describe(scores.front()));
    REQUIRE(scores.front().effects.size() == effects);
    const EffectScore& play = scores.front().effects.front();
    CHECK(play.strength > least_strength);
    REQUIRE(play.named);
    CHECK(play.relative_error < 0.2);
    CHECK(play.in_interval);
}

} // namespace

TEST_CASE("backlash is named with its gap even if the impact is not the whole joint's") {
    for (const auto& [robot, seed] :
         {std::pair{"three_joint_torque", 101600}, std::pair{"ur5_torque", 101604}}) {
        PanelMix mix;
        mix.effect = "backlash";
        mix.robot = robot;
        check_named(mix, static_cast<std::uint64_t>(seed), 1, 3);
    }
}

TEST_CASE("backlash without impacts is named with its gap, without and with friction at the link") {
    PanelMix mix;
    mix.effect = "greased_backlash";
    mix.strength = 3;
    constexpr double least_strength = 2.5; // the panel reaches the strength within 15 %
    check_named(mix, 303058, 1, least_strength);
    check_named(mix, 303044, 2, least_strength);
}
