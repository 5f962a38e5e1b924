// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_share = 0.01; ///< of an output's variance that any model leaves
constexpr double certain_ratio = 0.8;
constexpr double likely_ratio = 0.5;
constexpr int likely_turns = 2; ///< reversals of a joint that loads its output with gravity

/// An alternative interpretation of the columns or of the robot.
struct Reading {
    SetupFault fault;
    bool may_refuse; ///< false: a warning at most
    std::string columns;
    std::string expected, remedy; ///< parts of the text, before and after the comparison
    std::vector<Index> concerned; ///< affected outputs, which the text compares; empty: all
    VectorXd left;                ///< remaining share of each output's variance
};

std::string name(const std::vector<std::string>& names, Index index) {
    return names[static_cast<std::size_t>(index)];
}

double share_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts,
                  const VectorXd& output, Index k) {
    return left_by(output, expected_columns(arm, motion, parts, k));
}

/// Remaining variance shares of each output along a motion.
VectorXd shares_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts) {
    VectorXd left(arm.counted());
    for (Index k = 0; k < left.size(); ++k) {
        left[k] = share_left(arm, motion, parts, arm.output(k), k);
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
        all[k] = share_left(arm, arm.recorded.motion, parts, -arm.output(k), k);
        VectorXd left = now;
        left[k] = all[k];
        readings.push_back({SetupFault::torque_sign,
                            true,
                            name(names, k),
                            "column " + name(names, k) + expected,
                            "multiply it by -1",
                            {k},
                            left});
    }
    readings.push_back(
        {SetupFault::torque_sign,
         true,
         listed(names),
         "columns " + listed(names) + expected,
         arm.wrench() ? "multiply them by -1, or see --wrench-direction" : "multiply them by -1",
         {},
         all});
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
            {one, other},
            std::move(left)};
}

void add_exchanges(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                   std::vector<Reading>& readings) {
    const RobotMotion& motion = arm.recorded.motion;
    for (Index one = 0; one < now.size(); ++one) {
        for (Index other = one + 1; other < now.size(); ++other) {
            VectorXd left = now;
            left[one] = share_left(arm, motion, parts, arm.output(other), one);
            left[other] = share_left(arm, motion, parts, arm.output(one), other);
            readings.push_back(exchange(arm, false, one, other, std::move(left)));
        }
    }
    for (Index one = 0; one < motion.position.cols(); ++one) {
        for (Index other = one + 1; other < motion.position.cols(); ++other) {
            RobotMotion exchanged = motion;
            transform(exchanged,
                      [&](MatrixXd& coordinate) { coordinate.col(one).swap(coordinate.col(other)); });
            Reading reading = exchange(arm, true, one, other, shares_left(arm, exchanged));
            if (arm.wrench()) {
                reading.concerned.clear();
            }
            readings.push_back(std::move(reading));
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
        {SetupFault::gravity,
         arm.counted() > 1,
         columns,
         "columns " + columns + ": expected gravity as in the robot's model, found the opposite",
         "gravity upside down (" + gravity_option(arm.robot) + "), or the zeros of joints",
         {},
         shares_left(turned, arm.recorded.motion)});
}

void add_degrees(const ArmRecording& arm, std::vector<Reading>& readings) {
    constexpr double one_turn = 2 * std::numbers::pi;
    if (!(arm.recorded.motion.position.cwiseAbs().maxCoeff() > one_turn)) {
        return;
    }
    RobotMotion motion = arm.recorded.motion;
    transform(motion, [](MatrixXd& coordinate) { coordinate *= std::numbers::pi / 180; });
    const std::string columns = listed(arm.recording.position.names);
    readings.push_back({SetupFault::position_unit,
                        true,
                        columns,
                        "columns " + columns + ": expected rad, found what looks like degrees",
                        unit_remedy("q", "deg"),
                        {},
                        shares_left(arm, motion)});
}

/// Sum over the outputs of the logarithm of the ratio of the remaining variances.
double log_ratio(const VectorXd& now, const VectorXd& then) {
    return (now.cwiseMax(least_share).array() / then.cwiseMax(least_share).array()).log().sum();
}

/// Returns whether a joint's motion can show the alternative in its output. Without gravity only the friction
/// at several reversals shows a sign.
bool moves_enough(const ArmRecording& arm, const RigidParts& parts, SetupFault fault, Index joint) {
    if (arm.wrench()) {
        return true;
    }
    if (fault == SetupFault::torque_sign && parts.gravity.col(joint).isZero(0)) {
        return friction_sign(arm.recorded, joint) == FrictionSign::drives;
    }
    return swings(arm.recorded.motion, joint, likely_turns);
}

/// Returns whether an alternative explains a badly explained output much better, and no affected output
/// worse.
bool supported(const ArmRecording& arm, const RigidParts& parts, const Reading& reading,
               const VectorXd& now) {
    constexpr double much_better = 0.6;
    constexpr double half = 0.5;
    const double badly = reading.fault == SetupFault::gravity ? 0.05 : 0.15;
    std::vector<Index> outputs = reading.concerned;
    if (outputs.empty()) {
        outputs.resize(static_cast<std::size_t>(now.size()));
        std::iota(outputs.begin(), outputs.end(), Index{0});
    }
    const bool shown = std::ranges::any_of(outputs, [&](Index k) {
        return now[k] > badly && reading.left[k] < much_better * now[k] &&
               moves_enough(arm, parts, reading.fault, k);
    });
    const VectorXd before = now(outputs);
    const VectorXd after = reading.left(outputs);
    if (reading.concerned.empty()) {
        return shown && after.mean() < before.mean();
    }
    if (reading.fault == SetupFault::joint_order && before.mean() > badly &&
        (after.array() < half * before.array()).all()) {
        return true; // two outputs agree, for any motion of their joints
    }
    return shown && after.mean() < half * before.mean() && (after.array() < 1.1 * before.array()).all() &&
           std::ranges::all_of(reading.concerned,
                               [&](Index k) { return moves_enough(arm, parts, reading.fault, k); });
}

double mean_of(const VectorXd& left, const std::vector<Index>& concerned) {
    return concerned.empty() ? left.mean() : left(concerned).mean();
}

} // namespace

SetupFindings check_readings(const ArmRecording& arm) {
    constexpr double well_explained = 0.03;
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, arm.recorded.motion);
    const VectorXd now = shares_left(arm, arm.recorded.motion, parts);
    if (now.maxCoeff() < well_explained) {
        return {};
    }
    std::vector<Reading> readings;
    add_reversed_outputs(arm, parts, now, readings);
    add_reversed_positions(arm, readings);
    add_exchanges(arm, parts, now, readings);
    add_gravity(arm, readings);
    add_degrees(arm, readings);
    std::erase_if(readings, [&](const Reading& reading) { return !supported(arm, parts, reading, now); });
    if (readings.empty()) {
        return {};
    }
    const auto best = std::ranges::max_element(
        readings, {}, [&](const Reading& reading) { return log_ratio(now, reading.left); });
    const double ratio = log_ratio(now, best->left);
    if (!(ratio > likely_ratio)) {
        return {};
    }
    const bool certain = best->may_refuse && ratio > certain_ratio;
    return {{best->fault, certain ? Severity::mistake : Severity::warning, best->columns,
             best->expected + ": with the correction the model leaves " +
                 percent(mean_of(best->left, best->concerned)) + " of the variance instead of " +
                 percent(mean_of(now, best->concerned)) + "; " + best->remedy}};
}

} // namespace dfdyn::tools
