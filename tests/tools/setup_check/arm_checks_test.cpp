// SPDX-License-Identifier: Apache-2.0
// Loads, units, delays and zeros that the comparison with a robot shows.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/mistakes.hpp"
#include "tests/tools/setup_check/simulated_runs.hpp"
#include "tools/robot/inertia.hpp"
#include "tools/setup_check/checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <random>
#include <string>

namespace arm_checks_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;

/// Three slides, the last one vertical, and a wrist that turns about the first slide's axis.
Robot gantry() {
    Robot robot;
    robot.joints.resize(4);
    double mass = 6;
    for (std::size_t joint = 0; joint < 4; ++joint) {
        RobotJoint& one = robot.joints[joint];
        one.prismatic = joint < 3;
        one.axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(joint % 3));
        one.inertia = body_parameters(mass, {0, 0.04, -0.05}, 0.01 * Eigen::Matrix3d::Identity());
        mass /= 2;
    }
    robot.tip_placement.translation() = Eigen::Vector3d(0, 0, -0.3);
    return robot;
}

RunKind usual_run() {
    RunKind kind;
    kind.friction = 0.2;
    kind.noise = 0.01;
    return kind;
}

SetupFindings found(const Recording& recording, const Robot& robot) {
    return check_setup(recording, {OutputKind::joint_torque, &robot});
}

bool refused_as(const SetupFindings& findings, SetupFault fault) {
    return std::ranges::any_of(findings, [&](const SetupFinding& finding) {
        return finding.severity == Severity::mistake && finding.fault == fault;
    });
}

std::string texts_of(const SetupFindings& findings) {
    std::string texts;
    for (const SetupFinding& finding : findings) {
        texts += finding.text + "\n";
    }
    return texts;
}

TEST_CASE("a tool on a wrist that slides accelerate is accepted as a payload") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = gantry();
    RunKind kind;
    kind.speed = 2;
    kind.noise = 0.01;
    kind.payload_kg = 1.5;
    for (int run = 0; run < 5; ++run) {
        CAPTURE(run);
        CHECK(texts_of(found(simulated_run(robot, kind, engine), robot)) == "");
    }
}

TEST_CASE("torques of the motors before gears of 10 to 49 and of 100 are another unit") {
    DFDYN_SEEDED_ENGINE(engine);
    const double ratio = GENERATE(10.0, 30.0, 49.0, 100.0);
    CAPTURE(ratio);
    const Robot robot = ur5();
    Recording recording = simulated_run(robot, usual_run(), engine);
    CHECK(texts_of(found(recording, robot)) == "");
    scale(recording.output, 1 / ratio);
    const SetupFindings findings = found(recording, robot);
    CHECK(refused_as(findings, SetupFault::output_unit));
    CHECK_THAT(texts_of(findings), ContainsSubstring("torques of the motors"));
}

/// Adds the torque of a rotor that the robot's file lacks, by differences of exact positions.
void add_rotor(Recording& recording, std::size_t joint, double armature) {
    const std::size_t joints = recording.joint_count();
    for (std::size_t row = 1; row + 1 < recording.row_count(); ++row) {
        const double step_s = recording.time_s[row] - recording.time_s[row - 1];
        const double change = recording.position.row(row + 1)[joint] +
                              recording.position.row(row - 1)[joint] - 2 * recording.position.row(row)[joint];
        recording.output.values[row * joints + joint] += armature * change / (step_s * step_s);
    }
}

TEST_CASE("rotors that the file lacks hide no scale of the outputs and are none") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = ur5();
    RunKind kind = usual_run();
    kind.position_noise = 0;
    Recording recording = simulated_run(robot, kind, engine);
    add_rotor(recording, 0, 10);
    for (const std::size_t wrist : {3U, 4U, 5U}) {
        add_rotor(recording, wrist, 0.5); // kg·m², many times the links'
    }
    CHECK_FALSE(refused_as(found(recording, robot), SetupFault::output_unit));
    scale(recording.output, 0.1);
    CHECK(refused_as(found(recording, robot), SetupFault::output_unit));
}

TEST_CASE("a heavy tool on two slow wrist joints is no mistake") {
    std::mt19937_64 engine(1);
    const Robot robot = icub_right_arm();
    RunKind kind = usual_run();
    kind.speed = 0.2;
    kind.payload_kg = 1.5; // many times the hand
    kind.moving.assign(robot.joints.size(), false);
    kind.moving[robot.joints.size() - 2] = kind.moving[robot.joints.size() - 1] = true;
    const SetupFindings findings = found(simulated_run(robot, kind, engine), robot);
    CAPTURE(texts_of(findings));
    CHECK_FALSE(any_mistake(findings));
}

TEST_CASE("an output scale that gravity does not show is a warning and a small factor is none") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = planar_arm(0);
    Recording recording = simulated_run(robot, usual_run(), engine);
    scale(recording.output, 4);
    CHECK(texts_of(found(recording, robot)) == "");
    scale(recording.output, 5);
    const SetupFindings findings = found(recording, robot);
    CHECK_FALSE(any_mistake(findings));
    CHECK_THAT(texts_of(findings), ContainsSubstring("another unit"));
}

/// Pairs each row's outputs with the positions `rows` rows before.
Recording with_late_positions(const Recording& recording, std::size_t rows) {
    Recording late = cut(recording, 0, recording.row_count() - rows, 1);
    const auto first = static_cast<std::ptrdiff_t>(rows * recording.output.names.size());
    late.output.values.assign(recording.output.values.begin() + first, recording.output.values.end());
    return late;
}

TEST_CASE("a common delay of the positions is suspected with its length") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = ur5();
    RunKind kind = usual_run();
    kind.speed = 2;
    const Recording recording = simulated_run(robot, kind, engine);
    CHECK(texts_of(found(recording, robot)) == "");
    const auto rows = GENERATE(4U, 20U); // 40 and 200 ms
    const SetupFindings findings = found(with_late_positions(recording, rows), robot);
    CHECK_THAT(texts_of(findings), ContainsSubstring(rows == 4 ? "about 40 ms early" : "about 200 ms early"));
    CHECK(std::ranges::any_of(findings, [](const SetupFinding& finding) {
        return finding.fault == SetupFault::clock && finding.severity == Severity::warning;
    }));
}

TEST_CASE("a zero that is a quarter of a turn off is named") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = ur5();
    Recording recording = simulated_run(robot, usual_run(), engine);
    const std::size_t joint = GENERATE(1U, 2U);
    change_positions(recording, [&](double* q) { q[joint] += std::numbers::pi / 2; });
    const auto checked = checked_motion(recording);
    REQUIRE(checked);
    const ArmRecording arm{robot, recording, OutputKind::joint_torque, checked->recorded, true};
    const SetupFindings findings = check_zeros(arm, rigid_parts(robot, arm.kind, arm.recorded.motion));
    CHECK(refused_as(findings, SetupFault::wrong_robot));
    const std::string column = "column q" + std::to_string(joint + 1);
    CHECK_THAT(texts_of(findings),
               ContainsSubstring(column + ": expected the zero") && ContainsSubstring("subtract pi/2"));
}

TEST_CASE("a zero that is a quarter of a turn off is named by the whole check") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = ur5();
    Recording recording = simulated_run(robot, usual_run(), engine);
    change_positions(recording, [](double* q) { q[1] += std::numbers::pi / 2; });
    const SetupFindings findings = found(recording, robot);
    CHECK(refused_as(findings, SetupFault::wrong_robot));
    CHECK_THAT(texts_of(findings),
               ContainsSubstring("column q2: expected the zero") && ContainsSubstring("subtract pi/2"));
}

TEST_CASE("gravity along another axis is not called a zero of a joint") {
    std::mt19937_64 engine(1);
    const Robot floor = ur5();
    Robot wall = floor;
    wall.gravity = {9.81, 0, 0};
    const SetupFindings findings = found(simulated_run(wall, usual_run(), engine), floor);
    CHECK_FALSE(findings.empty());
    CHECK_THAT(texts_of(findings), !ContainsSubstring("expected the zero"));
}

TEST_CASE("one continuous joint in degrees is named") {
    DFDYN_SEEDED_ENGINE(engine);
    Robot robot = ur5();
    for (RobotJoint& joint : robot.joints) {
        joint.lower = joint.upper = std::nullopt;
    }
    Recording recording = simulated_run(robot, usual_run(), engine);
    CHECK(texts_of(found(recording, robot)) == "");
    change_positions(recording, [](double* q) { q[1] *= 180 / std::numbers::pi; });
    const SetupFindings findings = found(recording, robot);
    CHECK(refused_as(findings, SetupFault::position_unit));
    CHECK_THAT(texts_of(findings), ContainsSubstring("--units 'q=rad|deg|rad|rad|rad|rad'"));
}

} // namespace arm_checks_test
