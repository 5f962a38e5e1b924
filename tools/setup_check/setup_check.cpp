// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/setup_check.hpp"

#include "tools/setup_check/checks.hpp"
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"

#include <Eigen/Core>

#include <iterator>
#include <utility>

namespace dfdyn::tools {

namespace {

void append(SetupFindings& findings, SetupFindings&& more) {
    findings.insert(findings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

/// Returns the findings of the first check that has any, because later checks would report the same mistake
/// differently; and a common delay, which can be its reason. A payload that makes outputs too large hides no
/// wrong sign or order.
SetupFindings check_by_robot(const Recording& recording, const SetupQuestion& question,
                             CheckedMotion checked) {
    const bool current = question.outputs == OutputKind::motor_current;
    const bool gains_known = !current || !question.torque_constants.empty();
    if (current && gains_known) {
        Eigen::MatrixXd& outputs = checked.recorded.outputs;
        outputs *=
            Eigen::Map<const Eigen::VectorXd>(question.torque_constants.data(), outputs.cols()).asDiagonal();
    }
    const ArmRecording arm{*question.robot, recording, question.outputs, std::move(checked.recorded),
                           gains_known};
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, arm.recorded.motion);
    const OutputSizes sizes = output_sizes(arm, parts);
    SetupFindings findings = check_output_size(arm, parts, sizes);
    if (!any_mistake(findings)) {
        append(findings, check_readings(arm, parts));
    }
    if (findings.empty()) {
        append(findings, check_robot_match(arm, parts));
        if (!findings.empty()) {
            if (SetupFindings zeros = check_zeros(arm, parts); !zeros.empty()) {
                findings = std::move(zeros);
            }
        }
    }
    if (findings.empty()) {
        append(findings, check_output_scale(arm, parts, sizes));
    }
    append(findings, check_output_delay(arm, parts, checked.rows));
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
    const bool same_joints =
        question.robot != nullptr && question.robot->joints.size() == recording.joint_count();
    const Robot* const robot = same_joints ? question.robot : nullptr;
    SetupFindings findings = check_clock(recording);
    append(findings, check_wrapping(recording, robot));
    append(findings, check_position_unit(recording, robot));
    append(findings, check_filler_rows(recording));
    append(findings, check_dead_outputs(recording, question.outputs, question.robot));
    append(findings, check_output_unit(recording, question.outputs, robot));
    append(findings, check_saturated_outputs(recording, question.outputs));
    if (!any_mistake(findings)) {
        append(findings, check_stamps(recording));
    }
    if (any_mistake(findings)) {
        return findings;
    }
    const auto checked = checked_motion(recording);
    if (!checked) {
        return findings;
    }
    append(findings, check_degrees_by_gravity(recording, checked->recorded));
    if (!any_mistake(findings)) {
        append(findings, check_quantised_positions(recording));
    }
    if (!any_mistake(findings) && robot_fits(recording, question)) {
        append(findings, check_by_robot(recording, question, *checked));
    }
    if (!any_mistake(findings)) {
        append(findings, check_friction_sign(recording, checked->recorded, question.outputs));
    }
    return findings;
}

} // namespace dfdyn::tools
