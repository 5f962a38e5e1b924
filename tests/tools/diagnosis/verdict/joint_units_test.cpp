// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/joint_units.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/output/diagnosis_summary.hpp"
#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

namespace joint_units_test {

using namespace dfdyn::tools;

/// The UR5 with a prismatic third joint.
Robot arm_with_slide() {
    Robot robot = dfdyn::tests::ur5();
    robot.joints[2].prismatic = true;
    return robot;
}

/// The arm swings for 20 s. Its third joint has viscous friction of 40 N·s/m.
Recording recording_with_friction(const Robot& robot) {
    const DiagnosisSignals signals = dfdyn::tests::signals_of(robot, OutputKind::joint_torque);
    std::mt19937_64 engine(5);
    std::normal_distribution<double> noise(0, 0.3);
    Recording recording;
    recording.position.names = joint_names("q", 6);
    recording.output.names = output_names(OutputKind::joint_torque, 6);
    const RobotMotion& motion = signals.measured.motion;
    for (Eigen::Index row = 0; row < signals.rows(); ++row) {
        recording.time_s.push_back(signals.measured.time_s[row]);
        recording.time_ns.push_back(std::llround(signals.measured.time_s[row] * 1e9));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (Eigen::Index joint = 0; joint < 6; ++joint) {
            const double friction = joint == 2 ? 40 * motion.velocity(row, joint) : 0;
            recording.position.values.push_back(motion.position(row, joint));
            recording.output.values.push_back(signals.nominal(row, joint) + friction + noise(engine));
        }
    }
    return recording;
}

TEST_CASE("parameters and errors of a prismatic joint are in newtons and metres") {
    const Robot robot = arm_with_slide();
    DiagnosisOptions options;
    options.measure = false;
    options.check_setup = false;
    const Diagnosis diagnosis = diagnose(robot, recording_with_friction(robot), options).diagnosis;
    const auto friction = std::ranges::find_if(diagnosis.findings, [](const Finding& one) {
        return one.effect == "viscous_friction" && one.where == "joint3";
    });
    REQUIRE(friction != diagnosis.findings.end());
    CHECK(friction->parameters.front().value == Approx(40).epsilon(0.1));
    CHECK(friction->parameters.front().unit == "N·s/m");
    CHECK(diagnosis.output_units == std::vector<std::string>{"N·m", "N·m", "N", "N·m", "N·m", "N·m"});
    std::ostringstream text;
    print_diagnosis(text, diagnosis, {});
    CHECK_THAT(text.str(), Catch::Matchers::ContainsSubstring("N·s/m"));
    CHECK_THAT(text.str(), Catch::Matchers::ContainsSubstring(" N; plain least squares"));
}

TEST_CASE("a prismatic joint has no eccentric encoder") {
    const DiagnosisSignals signals = dfdyn::tests::signals_of(arm_with_slide(), OutputKind::joint_torque);
    const auto eccentric_at = [&](const char* where) {
        return std::ranges::any_of(static_candidates(signals), [where](const Candidate& one) {
            return one.effect == "encoder_eccentricity" && one.where == where;
        });
    };
    CHECK_FALSE(eccentric_at("encoder3"));
    CHECK(eccentric_at("encoder2"));
}

TEST_CASE("units at revolute joints remain") {
    for (const char* const unit : {"N·m", "N·m·s/rad", "rad", "kg·m²", "1", "s"}) {
        CHECK(unit_at_joint(unit, false) == unit);
    }
    CHECK(unit_at_joint("kg·m²", true) == "kg");
    CHECK(unit_at_joint("1", true) == "1");
}

} // namespace joint_units_test
