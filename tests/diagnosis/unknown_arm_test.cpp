// SPDX-License-Identifier: Apache-2.0
// The arms that differ from case to case.
#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tests/diagnosis/panel/score/run_panel.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

using namespace dfdyn::tools;
using namespace dfdyn::tests;

namespace {

PanelMix unknown_arms() {
    PanelMix mix;
    mix.robot = unknown_arm;
    return mix;
}

bool is_friction(const FindingScore& finding) {
    const dfdyn::tools::Effect* const effect = dfdyn::tools::find_effect(finding.effect);
    return effect != nullptr && effect->friction;
}

} // namespace

TEST_CASE("an unknown arm consists of bodies that can exist, also on both sides of its sensor") {
    for (std::uint64_t one = 0; one < 300; ++one) {
        CAPTURE(seed() + one);
        const Robot robot = draw_unknown_arm(seed() + one).robot;
        REQUIRE((robot.joints.size() >= 2 && robot.joints.size() <= 7));
        REQUIRE(robot.gravity.norm() == Approx(9.81));
        for (const RobotJoint& joint : robot.joints) {
            REQUIRE_FALSE(inertia_fault(joint.inertia));
        }
        if (robot.sensor && robot.sensor->link > 0) {
            const ForceTorqueSensor& sensor = *robot.sensor;
            REQUIRE_FALSE(inertia_fault(sensor.inertia_beyond));
            REQUIRE_FALSE(inertia_fault(robot.joints[sensor.link - 1].inertia - sensor.inertia_beyond));
        }
    }
}

TEST_CASE("unknown arms have two to seven joints, all outputs, and sizes from servos to machines") {
    std::vector<int> joints(8);
    std::vector<int> outputs(3);
    double lightest = 1e9;
    double heaviest = 0;
    for (std::uint64_t one = 0; one < 300; ++one) {
        const UnknownArm arm = draw_unknown_arm(seed() + one);
        ++joints[arm.robot.joints.size()];
        ++outputs[static_cast<std::size_t>(arm.kind.outputs)];
        double mass = 0;
        for (const RobotJoint& joint : arm.robot.joints) {
            mass += joint.inertia[0];
        }
        lightest = std::min(lightest, mass);
        heaviest = std::max(heaviest, mass);
    }
    for (std::size_t count = 2; count <= 7; ++count) {
        CHECK(joints[count] > 20);
    }
    CHECK(*std::ranges::min_element(outputs) > 20);
    CHECK(lightest < 3);
    CHECK(heaviest > 70);
}

TEST_CASE("a recording of an unknown arm is finite and within the joints' limits") {
    PanelMix mix = unknown_arms();
    mix.null_share = 1;
    int possible = 0;
    for (std::uint64_t one = 0; one < 8; ++one) {
        const std::optional<PanelCase> made = make_possible_case(seed() + one, mix);
        if (!made) {
            continue;
        }
        ++possible;
        const PanelCase& panel_case = *made;
        const Recording& recording = panel_case.recording;
        CAPTURE(seed() + one);
        CHECK(panel_case.hidden.empty());
        CHECK(recording.time_s.back() > 19);
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
                const RobotJoint& limits = panel_case.nominal.joints[joint];
                REQUIRE(recording.position.row(row)[joint] < limits.upper.value_or(1e3));
                REQUIRE(recording.position.row(row)[joint] > limits.lower.value_or(-1e3));
            }
            for (const double output : recording.output.row(row)) {
                REQUIRE(std::isfinite(output));
            }
        }
    }
    CHECK(possible >= 4);
}

TEST_CASE("Coulomb friction is named or listed as indistinguishable where another kind is hardly better") {
    // Stribeck friction was named at joints 1 and 2, with 0.99 and 0.94.
    const std::vector<CaseScore> scores = run_panel(500018, 1, unknown_arms(), 1, [](const CaseScore&) {});
    REQUIRE(scores.size() == 1);
    const CaseScore& score = scores.front();
    INFO(describe(score));
    CHECK(std::ranges::count_if(score.findings, is_friction) >= 5);
    for (const FindingScore& finding : score.findings) {
        CHECK((finding.right || !is_friction(finding) || finding.confidence < 0.5));
    }
}
