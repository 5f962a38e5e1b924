// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <ranges>
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
constexpr double well_explained = 0.03; ///< share of the variance
constexpr double badly_explained = 0.15;
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

/// Remaining variance shares of each output along a motion.
VectorXd shares_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts) {
    VectorXd left(arm.counted());
    for (Index k = 0; k < left.size(); ++k) {
        left[k] = left_by(arm.output(k), expected_columns(arm, motion, parts, k));
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
        all[k] = left_by(-arm.output(k), expected_columns(arm, arm.recorded.motion, parts, k));
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
            left[one] = left_by(arm.output(other), expected_columns(arm, motion, parts, one));
            left[other] = left_by(arm.output(one), expected_columns(arm, motion, parts, other));
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

/// The zero of one joint that turns, a quarter or half a turn away.
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
    const double badly = reading.fault == SetupFault::gravity ? 0.05 : badly_explained;
    std::vector<Index> outputs = reading.concerned;
    if (outputs.empty()) {
        std::ranges::copy(std::views::iota(Index{0}, now.size()), std::back_inserter(outputs));
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
    // two outputs that agree suffice, for any motion of their joints
    const bool exchanged = reading.fault == SetupFault::joint_order && before.mean() > badly &&
                           (after.array() < half * before.array()).all();
    return exchanged ||
           (shown && after.mean() < half * before.mean() && (after.array() < 1.1 * before.array()).all() &&
            std::ranges::all_of(reading.concerned,
                                [&](Index k) { return moves_enough(arm, parts, reading.fault, k); }));
}

double mean_of(const VectorXd& left, const std::vector<Index>& concerned) {
    return concerned.empty() ? left.mean() : left(concerned).mean();
}

/// An alternative and the logarithm of its likelihood ratio.
struct BestReading {
    Reading reading;
    double ratio = 0;
};

std::optional<BestReading> best_of(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                                   std::vector<Reading> readings) {
    std::erase_if(readings, [&](const Reading& reading) { return !supported(arm, parts, reading, now); });
    const auto ratio = [&](const Reading& reading) { return log_ratio(now, reading.left); };
    const auto best = std::ranges::max_element(readings, {}, ratio);
    return best == readings.end() ? std::nullopt : std::optional(BestReading{*best, ratio(*best)});
}

SetupFinding finding_of(const BestReading& best, const VectorXd& now, const std::string& doubt) {
    const Reading& reading = best.reading;
    const bool certain = reading.may_refuse && best.ratio > certain_ratio;
    return {reading.fault, certain ? Severity::mistake : Severity::warning, reading.columns,
            reading.expected + ": with the correction the model leaves " +
                percent(mean_of(reading.left, reading.concerned)) + " of the variance instead of " +
                percent(mean_of(now, reading.concerned)) + "; " + reading.remedy + doubt};
}

/// Returns whether an alternative explains the outputs of all joints that move.
bool explains_moving(const ArmRecording& arm, const VectorXd& left) {
    std::vector<Index> moving;
    std::ranges::copy_if(std::views::iota(Index{0}, left.size()), std::back_inserter(moving), [&](Index k) {
        return arm.wrench() || swings(arm.recorded.motion, k, likely_turns);
    });
    return !moving.empty() &&
           (left(moving).maxCoeff() < badly_explained || left(moving).mean() < well_explained);
}

/// With gravity along another axis all joints but the first look like a wrong zero of the second.
SetupFinding finding_of_zero(const ArmRecording& arm, BestReading zero, const VectorXd& now) {
    if (!explains_moving(arm, zero.reading.left)) {
        zero.reading.expected =
            "column " + zero.reading.columns +
            ": expected the robot's outputs, found others, closer to those of another zero";
    }
    return finding_of(zero, now, ", or see whether base (--gravity) and links are as in the file");
}

} // namespace

SetupFindings check_readings(const ArmRecording& arm, const RigidParts& parts) {
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
    const std::optional<BestReading> best = best_of(arm, parts, now, std::move(readings));
    if (!best || !(best->ratio > likely_ratio)) {
        return {};
    }
    if (mean_of(best->reading.left, best->reading.concerned) < well_explained) {
        return {finding_of(*best, now, "")};
    }
    // a wrong zero can look like a sign or an order
    const std::optional<BestReading> zero = best_of(arm, parts, now, other_zeros(arm));
    if (zero && zero->ratio > best->ratio + certain_ratio) {
        return {finding_of_zero(arm, *zero, now)};
    }
    const bool units = best->reading.fault == SetupFault::position_unit;
    return {finding_of(*best, now, units ? "" : ", or see whether the joints' zeros are those of the model")};
}

SetupFindings check_zeros(const ArmRecording& arm, const RigidParts& parts) {
    const VectorXd now = shares_left(arm, arm.recorded.motion, parts);
    const std::optional<BestReading> zero = best_of(arm, parts, now, other_zeros(arm));
    const bool named = zero && zero->ratio > certain_ratio && explains_moving(arm, zero->reading.left);
    return named ? SetupFindings{finding_of_zero(arm, *zero, now)} : SetupFindings{};
}

} // namespace dfdyn::tools
