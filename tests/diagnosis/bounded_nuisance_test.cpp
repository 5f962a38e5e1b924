// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel_case.hpp"
#include "tests/support/catch.hpp"
#include "tools/diagnosis/diagnosis.hpp"

using namespace dfdyn::tests;
using namespace dfdyn::tools;

namespace {

PanelMix three_joints() {
    PanelMix mix;
    mix.robot = "three_joint_torque";
    mix.noise = "ar1_0.9";
    mix.masses_off = false;
    mix.null_share = 1;
    mix.duration_s = 30;
    return mix;
}

Diagnosis diagnosis_of(const Robot& robot, const Recording& recording) {
    DiagnosisOptions options;
    options.measure = false;
    return diagnose(robot, recording, options).diagnosis;
}

} // namespace

TEST_CASE("masses that are nuisance parameters remain within ten percent of the robot's file") {
    int masses = 0;
    for (const std::uint64_t seed : {7301, 7302, 7303}) {
        const PanelCase panel_case = make_panel_case(seed, three_joints());
        Robot wrong = panel_case.nominal;
        for (RobotJoint& joint : wrong.joints) {
            joint.inertia *= 1.6;
        }
        for (const GrantedQuantity& granted : diagnosis_of(wrong, panel_case.recording).granted) {
            INFO("seed " << seed << ", " << granted.where);
            REQUIRE(granted.given);
            CHECK(granted.parameter.value / *granted.given > 0.895);
            CHECK(granted.parameter.value / *granted.given < 1.105);
            ++masses;
        }
    }
    CHECK(masses > 0);
}
