// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/readings.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_unexplained = 0.3;
constexpr double far_better = 0.5;
constexpr double likely_better = 0.6;
constexpr int likely_turns = 2; ///< plausible turns of a joint

/// An alternative interpretation of the columns, and its residual.
struct Reading {
    SetupFindings finding; ///< exactly one
    double left = 1;       ///< mean remaining share of the outputs' variance
};

/// Keeps the interpretation with the smaller residual: a wrongly named mistake is worse than a warning.
void keep(std::optional<Reading>& best, Reading next) {
    if (!best || next.left < best->left) {
        best = std::move(next);
    }
}

std::string name(const std::vector<std::string>& names, Index index) {
    return names[static_cast<std::size_t>(index)];
}

/// Remaining variance shares of output j (row) if it is interpreted as output k (column).
MatrixXd shares_left(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts) {
    const Index count = arm.counted();
    MatrixXd left(count, count);
    for (Index k = 0; k < count; ++k) {
        const MatrixXd columns = expected_columns(arm, motion, parts, k);
        for (Index j = 0; j < count; ++j) {
            left(j, k) = left_by(arm.output(j), columns);
        }
    }
    return left;
}

/// Remaining variance shares of each output for another motion.
VectorXd own_shares_left(const ArmRecording& arm, const RobotMotion& motion) {
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, motion);
    VectorXd left(arm.counted());
    for (Index k = 0; k < left.size(); ++k) {
        left[k] = left_by(arm.output(k), expected_columns(arm, motion, parts, k));
    }
    return left;
}

std::string comparison_text(double then, double now) {
    return "leaves " + percent(then) + " of the variance instead of " + percent(now);
}

/// Remaining variance share of output j interpreted as output k along a motion, with any payload.
double left_beside_payload(const ArmRecording& arm, const RobotMotion& motion, Index j, Index k) {
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, motion);
    return fit_signed(arm.output(j), payload_columns(arm, motion, k), expected_columns(arm, motion, parts, k))
        .left;
}

RobotMotion with_exchanged(RobotMotion motion, Index one, Index other) {
    for (MatrixXd* const coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
        coordinate->col(one).swap(coordinate->col(other));
    }
    return motion;
}

/// Returns whether an exchange explains each of its two outputs much better, for any payload of the arm.
bool certain_exchange(const ArmRecording& arm, bool positions, Index one, Index other) {
    if (arm.wrench()) {
        return false;
    }
    const RobotMotion& motion = arm.recorded.motion;
    const double now_one = left_beside_payload(arm, motion, one, one);
    const double now_other = left_beside_payload(arm, motion, other, other);
    const RobotMotion exchanged = positions ? with_exchanged(motion, one, other) : motion;
    const double then_one = left_beside_payload(arm, exchanged, one, positions ? one : other);
    const double then_other = left_beside_payload(arm, exchanged, other, positions ? other : one);
    return now_one + now_other > least_unexplained && then_one < far_better * now_one &&
           then_other < far_better * now_other;
}

/// `now` and `then`: mean remaining shares of the two outputs (for a wrench: of all forces).
std::optional<Reading> exchange(const ArmRecording& arm, bool positions, Index one, Index other, double now,
                                double then, double all) {
    if (!(now > least_unexplained && then < likely_better * now)) {
        return std::nullopt;
    }
    const bool certain = certain_exchange(arm, positions, one, other);
    const std::vector<std::string>& names =
        positions ? arm.recording.position.names : arm.recording.output.names;
    const std::string pair = std::to_string(one + 1) + " and " + std::to_string(other + 1);
    return Reading{{{SetupFault::joint_order, certain ? Severity::mistake : Severity::warning,
                     name(names, one) + ", " + name(names, other),
                     (positions ? "positions " : "outputs ") + pair + " look exchanged: columns " +
                         name(names, one) + " and " + name(names, other) +
                         ": expected the order of the robot's joints, found that the other way round the "
                         "model " +
                         comparison_text(then, now) + "; exchange the columns' names"}},
                   all};
}

void try_exchanged_outputs(const ArmRecording& arm, const MatrixXd& left, std::optional<Reading>& best) {
    for (Index one = 0; one < left.rows(); ++one) {
        for (Index other = one + 1; other < left.rows(); ++other) {
            const double now = left(one, one) + left(other, other);
            const double then = left(one, other) + left(other, one);
            const double all = (left.trace() - now + then) / static_cast<double>(left.rows());
            if (auto reading = exchange(arm, false, one, other, now / 2, then / 2, all)) {
                keep(best, std::move(*reading));
            }
        }
    }
}

void try_exchanged_positions(const ArmRecording& arm, const VectorXd& now, std::optional<Reading>& best) {
    const Index joints = arm.recorded.motion.position.cols();
    for (Index one = 0; one < joints; ++one) {
        for (Index other = one + 1; other < joints; ++other) {
            const VectorXd then = own_shares_left(arm, with_exchanged(arm.recorded.motion, one, other));
            std::optional<Reading> reading =
                arm.wrench() ? exchange(arm, true, one, other, now.mean(), then.mean(), then.mean())
                             : exchange(arm, true, one, other, (now[one] + now[other]) / 2,
                                        (then[one] + then[other]) / 2, then.mean());
            if (reading) {
                keep(best, std::move(*reading));
            }
        }
    }
}

void try_degrees(const ArmRecording& arm, const VectorXd& now, std::optional<Reading>& best) {
    constexpr double one_turn = 2 * std::numbers::pi;
    if (!(arm.recorded.motion.position.cwiseAbs().maxCoeff() > one_turn)) {
        return;
    }
    RobotMotion motion = arm.recorded.motion;
    for (MatrixXd* const coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
        *coordinate *= std::numbers::pi / 180;
    }
    const double then = own_shares_left(arm, motion).mean();
    if (now.mean() > least_unexplained && then < far_better * now.mean()) {
        keep(best, {{{SetupFault::position_unit, Severity::mistake, listed(arm.recording.position.names),
                      "columns " + listed(arm.recording.position.names) +
                          ": expected rad, found what looks like degrees: with degrees the model " +
                          comparison_text(then, now.mean()) + "; multiply by pi/180"}},
                    then});
    }
}

void try_reversed_positions(const ArmRecording& arm, const VectorXd& now, std::optional<Reading>& best) {
    if (arm.wrench()) {
        return;
    }
    for (Index joint = 0; joint < now.size(); ++joint) {
        if (now[joint] < least_unexplained || !swings(arm.recorded.motion, joint, likely_turns)) {
            continue;
        }
        RobotMotion motion = arm.recorded.motion;
        for (MatrixXd* const coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
            coordinate->col(joint) *= -1;
        }
        const VectorXd then = own_shares_left(arm, motion);
        if (then[joint] < far_better * now[joint] && then.mean() < now.mean()) {
            const bool certain = friction_sign(arm.recorded, joint) == FrictionSign::drives;
            keep(best,
                 {{{SetupFault::torque_sign, certain ? Severity::mistake : Severity::warning,
                    name(arm.recording.position.names, joint),
                    "column " + name(arm.recording.position.names, joint) +
                        ": expected the direction of the robot's joint, found the opposite: the other way "
                        "round the model " +
                        comparison_text(then[joint], now[joint]) + "; multiply by -1"}},
                  then.mean()});
        }
    }
}

/// Evidence of an output's parts on its sign.
enum class SignEvidence { none, right, reversed, gravity_reversed, either_reversed };

SignEvidence sign_of(const ArmRecording& arm, const RigidParts& parts, Index k) {
    constexpr double explains = 0.4;
    constexpr double clearly = 0.7;
    const VectorXd output = arm.output(k);
    const RobotMotion& motion = arm.recorded.motion;
    const bool brakes = !arm.wrench() && swings(motion, k, likely_turns);
    if (!brakes && !arm.wrench() && arm.counted() > 1) {
        return SignEvidence::none;
    }
    MatrixXd columns(motion.rows(), brakes ? 4 : 1);
    if (brakes) { // by the joint's own acceleration: its inertia is positive for any payload
        columns << parts.gravity.col(k), motion.acceleration.col(k), friction_columns(motion, k);
    } else {
        columns << (arm.wrench() ? parts.sum(k) : VectorXd(parts.gravity.col(k)));
    }
    const double positive = left_by(output, columns);
    const double negative = left_by(output, -columns);
    columns.col(0) *= -1;
    const double gravity_negative = left_by(output, columns);
    if (positive < explains * std::min(negative, gravity_negative)) {
        return SignEvidence::right;
    }
    if (!(std::min(negative, gravity_negative) < explains * positive)) {
        return SignEvidence::none;
    }
    return negative < clearly * gravity_negative   ? SignEvidence::reversed
           : gravity_negative < clearly * negative ? SignEvidence::gravity_reversed
                                                   : SignEvidence::either_reversed;
}

/// Outputs by the evidence on their signs.
struct SignVotes {
    std::vector<Index> reversed, gravity_reversed, either_reversed;
    std::size_t right = 0;
};

SignVotes sign_votes(const ArmRecording& arm, const RigidParts& parts) {
    SignVotes votes;
    for (Index k = 0; k < arm.counted(); ++k) {
        switch (sign_of(arm, parts, k)) {
        case SignEvidence::none:
            break;
        case SignEvidence::right:
            ++votes.right;
            break;
        case SignEvidence::reversed:
            votes.reversed.push_back(k);
            break;
        case SignEvidence::gravity_reversed:
            votes.gravity_reversed.push_back(k);
            break;
        case SignEvidence::either_reversed:
            votes.either_reversed.push_back(k);
            break;
        }
    }
    return votes;
}

/// Returns whether at least half of the outputs with moving joints, and at least two, have gravity of the
/// wrong sign, and none has the right one. No payload causes this.
bool most_agree(const ArmRecording& arm, const SignVotes& votes) {
    std::size_t opposite = 0;
    std::size_t certain = 0;
    for (const std::vector<Index>* const outputs :
         {&votes.reversed, &votes.gravity_reversed, &votes.either_reversed}) {
        opposite += outputs->size();
        for (const Index k : *outputs) {
            certain += arm.wrench() || swings(arm.recorded.motion, k, certain_turns) ? 1 : 0;
        }
    }
    std::size_t moving = 0;
    for (Index k = 0; k < arm.counted(); ++k) {
        moving += arm.wrench() || swings(arm.recorded.motion, k, likely_turns) ? 1 : 0;
    }
    return votes.right == 0 && certain > 1 && 2 * opposite >= moving;
}

std::string column_names(const ArmRecording& arm, const std::vector<Index>& outputs) {
    std::vector<std::string> names;
    for (const Index k : outputs) {
        names.push_back(name(arm.recording.output.names, k));
    }
    return listed(names);
}

/// Mean remaining share if these outputs are multiplied by -1.
double left_with_reversed(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                          const std::vector<Index>& outputs) {
    double left = now.sum();
    for (const Index k : outputs) {
        left += left_by(-arm.output(k), expected_columns(arm, arm.recorded.motion, parts, k)) - now[k];
    }
    return left / static_cast<double>(now.size());
}

void try_reversed_outputs(const ArmRecording& arm, const RigidParts& parts, const VectorXd& now,
                          std::optional<Reading>& best) {
    const SignVotes votes = sign_votes(arm, parts);
    if (!votes.reversed.empty()) {
        const bool certain =
            most_agree(arm, votes) || std::ranges::any_of(votes.reversed, [&](Index k) {
                return !arm.wrench() && friction_sign(arm.recorded, k) == FrictionSign::drives;
            });
        keep(best, {{{SetupFault::torque_sign, certain ? Severity::mistake : Severity::warning,
                      column_names(arm, votes.reversed),
                      "columns " + column_names(arm, votes.reversed) +
                          ": expected the sign of the robot's model, found the opposite in gravity and "
                          "friction: multiply by -1, or turn the sign of the joint's position"}},
                    left_with_reversed(arm, parts, now, votes.reversed)});
        return;
    }
    std::vector<Index> opposite = votes.gravity_reversed;
    opposite.insert(opposite.end(), votes.either_reversed.begin(), votes.either_reversed.end());
    if (opposite.empty() || votes.right > 0) {
        return; // a payload can reverse the gravity torque of one joint
    }
    const bool friction_is_right = votes.either_reversed.empty();
    const std::string cause =
        arm.wrench()        ? "multiply the wrench by -1, or see --wrench-direction and --gravity"
        : friction_is_right ? "gravity upside down (--gravity), or the zeros of joints"
                            : "multiply by -1, or see --gravity and the zeros of the joints";
    keep(best, {{{friction_is_right ? SetupFault::gravity : SetupFault::torque_sign,
                  most_agree(arm, votes) ? Severity::mistake : Severity::warning, column_names(arm, opposite),
                  "columns " + column_names(arm, opposite) +
                      ": expected gravity as in the robot's model, found the opposite: " + cause}},
                left_with_reversed(arm, parts, now, opposite)});
}

} // namespace

SetupFindings check_readings(const ArmRecording& arm) {
    constexpr double well_explained = 0.15;
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, arm.recorded.motion);
    const MatrixXd left = shares_left(arm, arm.recorded.motion, parts);
    const VectorXd now = left.diagonal();
    if (now.maxCoeff() < well_explained) {
        return {};
    }
    std::optional<Reading> best;
    try_reversed_outputs(arm, parts, now, best);
    try_exchanged_outputs(arm, left, best);
    try_exchanged_positions(arm, now, best);
    try_reversed_positions(arm, now, best);
    try_degrees(arm, now, best);
    return best ? best->finding : SetupFindings{};
}

} // namespace dfdyn::tools
