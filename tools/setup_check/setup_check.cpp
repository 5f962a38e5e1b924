// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/setup_check.hpp"

#include "tools/setup_check/checks.hpp"
#include "tools/setup_check/rigid_comparison.hpp"

#include <Eigen/Core>

#include <iterator>
#include <utility>

namespace dfdyn::tools {

namespace {

void append(SetupFindings& findings, SetupFindings&& more) {
    findings.insert(findings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

/// Returns the finding of the first check with one, because later checks would report the same mistake
/// differently.
SetupFindings check_by_robot(const Recording& recording, const SetupQuestion& question,
                             RecordedMotion recorded) {
    const bool current = question.outputs == OutputKind::motor_current;
    const bool gains_known = !current || !question.torque_constants.empty();
    if (current && gains_known) {
        recorded.outputs *=
            Eigen::Map<const Eigen::VectorXd>(question.torque_constants.data(), recorded.outputs.cols())
                .asDiagonal();
    }
    const ArmRecording arm{*question.robot, recording, question.outputs, std::move(recorded), gains_known};
    SetupFindings findings = check_output_size(arm);
    if (findings.empty()) {
        append(findings, check_readings(arm));
    }
    if (findings.empty()) {
        append(findings, check_robot_match(arm));
    }
    return findings;
}

/// Returns whether the question's parts are consistent.
bool robot_fits(const Recording& recording, const SetupQuestion& question) {
    const std::size_t joints = recording.joint_count();
    const std::vector<double>& constants = question.torque_constants;
    return question.robot != nullptr && question.robot->joints.size() == joints &&
           (question.outputs != OutputKind::motor_current || constants.empty() ||
            (constants.size() == joints && std::ranges::all_of(constants, [](double k) { return k > 0; })));
}

} // namespace

SetupFindings check_setup(const Recording& recording, const SetupQuestion& question) {
    SetupFindings findings = check_clock(recording);
    append(findings, check_wrapping(recording));
    append(findings, check_position_unit(recording, question.robot));
    append(findings, check_dead_outputs(recording, question.outputs, question.robot));
    append(findings, check_output_unit(recording, question.outputs));
    append(findings, check_saturated_outputs(recording, question.outputs));
    if (!any_mistake(findings)) {
        append(findings, check_stamps(recording));
    }
    if (any_mistake(findings)) {
        return findings;
    }
    const auto recorded = checked_motion(recording);
    if (!recorded) {
        return findings;
    }
    append(findings, check_degrees_by_gravity(recording, *recorded));
    if (!any_mistake(findings)) {
        append(findings, check_quantised_positions(recording));
    }
    if (!any_mistake(findings) && robot_fits(recording, question)) {
        append(findings, check_by_robot(recording, question, *recorded));
    }
    if (!any_mistake(findings)) {
        append(findings, check_friction_sign(recording, *recorded, question.outputs));
    }
    return findings;
}

} // namespace dfdyn::tools
