// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/setup_check/checks.hpp"
#include "tools/setup_check/friction_sign.hpp"
#include "tools/setup_check/rigid_body/alternative_readings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double least_share = 0.01; ///< of an output's variance that any model leaves
constexpr double certain_ratio = 0.8;
constexpr double likely_ratio = 0.5;
constexpr double well_explained = 0.03; ///< share of the variance
constexpr double badly_explained = 0.15;
constexpr int likely_turns = 2; ///< reversals of a joint that loads its output with gravity

/// Sum over the outputs of the logarithm of the ratio of the remaining variances.
double log_ratio(const VectorXd& now, const VectorXd& then) {
    return (now.cwiseMax(least_share).array() / then.cwiseMax(least_share).array()).log().sum();
}

/// Returns whether a joint's motion can show the alternative in its output. Without gravity this takes
/// several reversals, and only the friction at these shows a sign.
bool moves_enough(const ArmRecording& arm, const RigidParts& parts, SetupFault fault, Index joint) {
    if (arm.wrench()) {
        return true;
    }
    const bool unloaded = parts.gravity.col(joint).isZero(0);
    if (fault == SetupFault::torque_sign && unloaded) {
        return friction_sign(arm.recorded, joint).sign == FrictionSign::drives;
    }
    return swings(arm.recorded.motion, joint, unloaded ? certain_turns : likely_turns);
}

/// Returns whether the friction of one of two joints brakes it in the other's output.
bool friction_exchanged(const ArmRecording& arm, Index one, Index other) {
    RecordedMotion exchanged = arm.recorded;
    exchanged.outputs.col(one).swap(exchanged.outputs.col(other));
    return friction_sign(exchanged, one).sign == FrictionSign::brakes ||
           friction_sign(exchanged, other).sign == FrictionSign::brakes;
}

/// Returns whether a joint reverses several times, and its acceleration is not mainly the noise of its
/// positions.
bool accelerates(const ArmRecording& arm, Index joint) {
    const RobotMotion& motion = arm.recorded.motion;
    const double noise = acceleration_noise(arm.recording, joint);
    const double rms = motion.acceleration.col(joint).norm() / std::sqrt(static_cast<double>(motion.rows()));
    return swings(motion, joint, certain_turns) && noise * noise < badly_explained * rms * rms;
}

/// Returns whether gravity, friction or inertia show an exchange. The friction of a motion in one direction
/// looks like any smooth signal, and slow accelerations are noise. So the set-up must explain the outputs
/// badly that gravity dominates: one whose joint reverses, or both. Without such an output, the friction or
/// the accelerations of several reversals must show it.
bool order_shown(const ArmRecording& arm, const RigidParts& parts, const Reading& reading,
                 const VectorXd& now) {
    if (arm.wrench()) {
        return true;
    }
    const VectorXd weight = deviations(parts.gravity);
    const VectorXd inertia = deviations(parts.inertia);
    std::vector<Index> loaded;
    std::ranges::copy_if(reading.concerned, std::back_inserter(loaded),
                         [&](Index k) { return weight[k] > inertia[k]; });
    const auto badly = [&](Index k) { return now[k] > badly_explained; };
    if (loaded.empty()) {
        return std::ranges::all_of(reading.concerned, [&](Index k) { return accelerates(arm, k); }) ||
               friction_exchanged(arm, reading.concerned[0], reading.concerned[1]);
    }
    return (loaded.size() == 2 && std::ranges::all_of(loaded, badly)) ||
           std::ranges::any_of(
               loaded, [&](Index k) { return badly(k) && swings(arm.recorded.motion, k, likely_turns); });
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
    const auto enough = [&](Index k) { return moves_enough(arm, parts, reading.fault, k); };
    const bool shown = std::ranges::any_of(outputs, [&](Index k) {
        return now[k] > badly && reading.left[k] < much_better * now[k] && enough(k);
    });
    const VectorXd before = now(outputs);
    const VectorXd after = reading.left(outputs);
    if (reading.concerned.empty()) {
        return shown && after.mean() < before.mean();
    }
    const bool both = reading.fault == SetupFault::joint_order && before.mean() > badly &&
                      (after.array() < half * before.array()).all();
    const bool better = shown && after.mean() < half * before.mean() &&
                        (after.array() < 1.1 * before.array()).all() &&
                        std::ranges::all_of(reading.concerned, enough);
    return both || better;
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
    if (best == readings.end()) {
        return std::nullopt;
    }
    best->may_refuse =
        best->may_refuse && (best->fault != SetupFault::joint_order || order_shown(arm, parts, *best, now));
    return BestReading{*best, ratio(*best)};
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
        zero.reading.may_refuse = !arm.wrench(); // whose fit has no payload
    }
    return finding_of(zero, now, ", or see whether base (--gravity) and links are as in the file");
}

} // namespace

SetupFindings check_readings(const ArmRecording& arm, const RigidParts& parts) {
    const VectorXd now = shares_left(arm, parts);
    if (now.maxCoeff() < well_explained) {
        return {};
    }
    const std::optional<BestReading> best = best_of(arm, parts, now, alternative_readings(arm, parts, now));
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
    const VectorXd now = shares_left(arm, parts);
    const std::optional<BestReading> zero = best_of(arm, parts, now, other_zeros(arm));
    const bool named = zero && zero->ratio > certain_ratio && explains_moving(arm, zero->reading.left);
    return named ? SetupFindings{finding_of_zero(arm, *zero, now)} : SetupFindings{};
}

} // namespace dfdyn::tools
