// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/rigid_body/alternative_readings.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/checks.hpp"

#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string name(const std::vector<std::string>& names, Index index) {
    return names[static_cast<std::size_t>(index)];
}

/// Remaining share of the variance of `output` as that of joint `k`, while the arm moves by the recording.
double share_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts, Index k,
                  const VectorXd& output) {
    const MatrixXd columns = expected_columns(arm, motion, parts, k);
    if (arm.wrench()) {
        return left_by(output, columns);
    }
    const std::vector<Index> rows = moving_rows(arm.recorded.motion);
    return left_by(output(rows), columns(rows, Eigen::all));
}

/// Remaining variance shares of each output along a motion.
VectorXd shares_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts) {
    VectorXd left(arm.counted());
    for (Index k = 0; k < left.size(); ++k) {
        left[k] = share_left(arm, motion, parts, k, arm.output(k));
    }
    return left;
}

VectorXd shares_left(const ArmRecording& arm, const RobotMotion& motion) {
    return shares_left(arm, motion, rigid_parts(arm.robot, arm.kind, motion));
}

void transform(RobotMotion& motion, auto change) {
    for (MatrixXd* const coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
        change(*coordinate);
    }
}

void add_reversed_outputs(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                          std::vector<Reading>& readings) {
    const std::vector<std::string>& names = arm.recording.output.names;
    const std::string expected = ": expected the sign of the robot's model, found the opposite";
    VectorXd all(now.size());
    for (Index k = 0; k < now.size(); ++k) {
        all[k] = share_left(arm, arm.recorded.motion, parts, k, -arm.output(k));
        VectorXd left = now;
        left[k] = all[k];
        readings.push_back({SetupFault::torque_sign, true, name(names, k),
                            "column " + name(names, k) + expected, "multiply it by -1", std::vector<Index>{k},
                            left});
    }
    readings.push_back(
        {SetupFault::torque_sign, true, listed(names), "columns " + listed(names) + expected,
         arm.wrench() ? "multiply them by -1, or see --wrench-direction" : "multiply them by -1",
         std::vector<Index>{}, all});
}

void add_reversed_positions(const ArmRecording& arm, std::vector<Reading>& readings) {
    for (Index joint = 0; joint < arm.recorded.motion.position.cols(); ++joint) {
        RobotMotion motion = arm.recorded.motion;
        transform(motion, [&](MatrixXd& coordinate) { coordinate.col(joint) *= -1; });
        const std::string column = name(arm.recording.position.names, joint);
        readings.push_back(
            {SetupFault::torque_sign, !arm.wrench(), column,
             "column " + column + ": expected the direction of the robot's joint, found the opposite",
             "multiply it by -1", arm.wrench() ? std::vector<Index>{} : std::vector<Index>{joint},
             shares_left(arm, motion)});
    }
}

Reading exchange(const ArmRecording& arm, bool positions, Index one, Index other, VectorXd left) {
    const std::vector<std::string>& names =
        positions ? arm.recording.position.names : arm.recording.output.names;
    const std::string pair = std::to_string(one + 1) + " and " + std::to_string(other + 1);
    return {SetupFault::joint_order,
            !arm.wrench(),
            name(names, one) + ", " + name(names, other),
            (positions ? "positions " : "outputs ") + pair + " look exchanged: columns " + name(names, one) +
                " and " + name(names, other) + ": expected the order of the robot's joints, found another",
            "exchange the two columns' names",
            positions && arm.wrench() ? std::vector<Index>{} : std::vector<Index>{one, other},
            std::move(left)};
}

void add_exchanges(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                   std::vector<Reading>& readings) {
    const RobotMotion& motion = arm.recorded.motion;
    for (Index one = 0; one < now.size(); ++one) {
        for (Index other = one + 1; other < now.size(); ++other) {
            VectorXd left = now;
            left[one] = share_left(arm, motion, parts, one, arm.output(other));
            left[other] = share_left(arm, motion, parts, other, arm.output(one));
            readings.push_back(exchange(arm, false, one, other, std::move(left)));
        }
    }
    for (Index one = 0; one < motion.position.cols(); ++one) {
        for (Index other = one + 1; other < motion.position.cols(); ++other) {
            RobotMotion exchanged = motion;
            transform(exchanged,
                      [&](MatrixXd& coordinate) { coordinate.col(one).swap(coordinate.col(other)); });
            readings.push_back(exchange(arm, true, one, other, shares_left(arm, exchanged)));
        }
    }
}

std::string gravity_option(const Robot& robot) {
    const Eigen::Vector3d gravity = robot.base_in_root * -robot.gravity;
    std::string text = "--gravity ";
    for (Index axis = 0; axis < 3; ++axis) {
        text += (axis == 0 ? "" : ",") + rounded_text(gravity[axis] == 0 ? 0 : gravity[axis]);
    }
    return text;
}

void add_gravity(const ArmRecording& arm, std::vector<Reading>& readings) {
    Robot robot = arm.robot;
    robot.gravity *= -1;
    const ArmRecording turned{robot, arm.recording, arm.kind, arm.recorded, arm.gains_known};
    const std::string columns = listed(arm.recording.output.names);
    readings.push_back(
        {SetupFault::gravity, arm.counted() > 1, columns,
         "columns " + columns + ": expected gravity as in the robot's model, found the opposite",
         "gravity upside down (" + gravity_option(arm.robot) + "), or the zeros of joints",
         std::vector<Index>{}, shares_left(turned, arm.recorded.motion)});
}

Reading in_degrees(const ArmRecording& arm, const std::vector<std::size_t>& joints) {
    RobotMotion motion = arm.recorded.motion;
    std::vector<std::string> names;
    std::vector<JointUnit> units(arm.robot.joints.size(), JointUnit::si);
    for (const std::size_t joint : joints) {
        transform(motion, [&](MatrixXd& coordinate) {
            coordinate.col(static_cast<Index>(joint)) *= std::numbers::pi / 180;
        });
        names.push_back(arm.recording.position.names[joint]);
        units[joint] = JointUnit::degrees;
    }
    return {SetupFault::position_unit,
            true,
            listed(names),
            "columns " + listed(names) + ": expected rad, found what looks like degrees",
            position_remedy(arm.recording, arm.robot, units),
            std::vector<Index>{},
            shares_left(arm, motion)};
}

/// Degrees at all joints that turn, at those beyond one turn, and at each of these.
void add_degrees(const ArmRecording& arm, std::vector<Reading>& readings) {
    constexpr double one_turn = 2 * std::numbers::pi;
    const VectorXd largest = arm.recorded.motion.position.cwiseAbs().colwise().maxCoeff();
    std::vector<std::size_t> turning;
    std::vector<std::size_t> beyond;
    for (std::size_t joint = 0; joint < arm.robot.joints.size(); ++joint) {
        if (!arm.robot.joints[joint].prismatic) {
            turning.push_back(joint);
            if (largest[static_cast<Index>(joint)] > one_turn) {
                beyond.push_back(joint);
            }
        }
    }
    if (!beyond.empty()) {
        readings.push_back(in_degrees(arm, turning));
    }
    if (beyond.size() > 1 && beyond.size() < turning.size()) {
        readings.push_back(in_degrees(arm, beyond));
    }
    for (const std::size_t joint : turning.size() > 1 ? beyond : std::vector<std::size_t>{}) {
        readings.push_back(in_degrees(arm, {joint}));
    }
}

} // namespace

VectorXd shares_left(const ArmRecording& arm, const RigidParts& parts) {
    return shares_left(arm, arm.recorded.motion, parts);
}

std::vector<Reading> alternative_readings(const ArmRecording& arm, const RigidParts& parts,
                                          const VectorXd& now) {
    std::vector<Reading> readings;
    add_reversed_outputs(arm, parts, now, readings);
    add_reversed_positions(arm, readings);
    add_exchanges(arm, parts, now, readings);
    add_gravity(arm, readings);
    add_degrees(arm, readings);
    return readings;
}

std::vector<Reading> other_zeros(const ArmRecording& arm) {
    std::vector<Reading> readings;
    for (std::size_t joint = 0; joint < arm.robot.joints.size(); ++joint) {
        if (arm.robot.joints[joint].prismatic) {
            continue;
        }
        const std::string& column = arm.recording.position.names[joint];
        for (const auto& [quarters, remedy] :
             {std::pair{-1, "subtract pi/2"}, {1, "add pi/2"}, {2, "add pi"}}) {
            RobotMotion motion = arm.recorded.motion;
            motion.position.col(static_cast<Index>(joint)).array() += quarters * std::numbers::pi / 2;
            readings.push_back(
                {SetupFault::wrong_robot, true, column,
                 "column " + column + ": expected the zero of the robot's joint, found another one", remedy,
                 std::vector<Index>{}, shares_left(arm, motion)});
        }
    }
    return readings;
}

} // namespace dfdyn::tools
