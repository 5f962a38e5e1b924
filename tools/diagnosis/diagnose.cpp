// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/diagnosis.hpp"

#include "tools/diagnosis/extension_errors.hpp"
#include "tools/diagnosis/findings.hpp"
#include "tools/diagnosis/granted.hpp"
#include "tools/diagnosis/unexplained.hpp"
#include "tools/physics/torque_constants.hpp"
#include "tools/setup_check/recording_checks.hpp"
#include "tools/setup_check/robot_checks.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Measured unit per N·m (N).
Eigen::VectorXd torque_gains(const DiagnosisSignals& signals, const DiagnosisOptions& options) {
    Eigen::VectorXd gains = Eigen::VectorXd::Ones(signals.outputs());
    if (options.outputs != OutputKind::motor_current) {
        return gains;
    }
    if (!options.torque_constants.empty()) {
        return Eigen::Map<const Eigen::VectorXd>(options.torque_constants.data(), gains.size())
            .cwiseInverse();
    }
    TrainingData data;
    data.positions = signals.measured.motion.position;
    data.velocities = signals.measured.motion.velocity;
    data.accelerations = signals.measured.motion.acceleration;
    data.outputs = signals.measured.outputs;
    const std::vector<TorqueGain> found =
        estimate_torque_gains(signals.robot, data, signals.sign_velocity.maxCoeff());
    for (Eigen::Index joint = 0; joint < gains.size(); ++joint) {
        gains[joint] = found[static_cast<std::size_t>(joint)].gain;
    }
    return gains;
}

/// What the file shows, before any motion is made of it.
SetupFindings findings_of_file(const Robot& robot, const Recording& recording) {
    SetupFindings findings = check_recording(recording);
    std::ranges::copy(check_duration(recording), std::back_inserter(findings));
    std::ranges::copy(check_position_limits(robot, recording), std::back_inserter(findings));
    return findings;
}

/// What the motion shows, and the rigid body's outputs along it. `torques`: T x m, from currents by their
/// gains; where these are not known, the currents themselves count.
SetupFindings findings_of_motion(const DiagnosisSignals& signals, const Diagnosis& diagnosis,
                                 const Eigen::MatrixXd& torques, bool gains_known) {
    SetupFindings findings = check_standstill(signals.measured.motion.position);
    if (!any_of_severity(findings, Severity::unanswerable)) {
        const RigidComparison comparison(
            signals.robot, signals.kind, diagnosis.output_names, signals.measured.motion,
            gains_known ? torques : signals.measured.outputs, signals.sign_velocity);
        std::ranges::copy(check_against_robot(comparison, gains_known), std::back_inserter(findings));
    }
    return findings;
}

/// Adds the findings' sentences, the gravest first. Returns whether the recording cannot answer.
bool add_suspicions(SetupFindings findings, Diagnosis& diagnosis) {
    std::ranges::stable_sort(findings, std::ranges::greater(), &SetupFinding::severity);
    for (SetupFinding& finding : findings) {
        diagnosis.suspicions.push_back(std::move(finding.text));
    }
    return any_of_severity(findings, Severity::unanswerable);
}

} // namespace

DiagnosisWork diagnose(const Robot& robot, const Recording& recording, const DiagnosisOptions& options) {
    DiagnosisWork work;
    work.diagnosis.output_names = recording.output.names;
    if (add_suspicions(findings_of_file(robot, recording), work.diagnosis)) {
        return work;
    }
    auto signals = std::make_shared<DiagnosisSignals>(
        diagnosis_signals(robot, options.outputs, measured_motion(recording)));
    work.signals = signals;
    work.torque_gains = torque_gains(*signals, options);
    work.measured = signals->measured.outputs * work.torque_gains.cwiseInverse().asDiagonal();
    const bool gains_known =
        options.outputs != OutputKind::motor_current || !options.torque_constants.empty();
    if (add_suspicions(findings_of_motion(*signals, work.diagnosis, work.measured, gains_known),
                       work.diagnosis)) {
        measure_from(work, 0, work.explanation); // without causes
        return work;
    }
    ExplanationOptions how{gains_known, 1, options.progress};
    work.explanation = explain(*signals, work.measured, how);
    work.rest = work.measured - signals->nominal - work.explanation.all(*signals);
    work.pushes = standing_contacts(*signals, work.explanation, work.measured, work.rest);
    for (const StandingContact& push : work.pushes) {
        work.rest.col(static_cast<Eigen::Index>(push.joint)) -= push.share;
    }
    work.diagnosis.findings =
        findings_of(*signals, work.explanation, work.pushes, work.rest, work.diagnosis.output_names);
    work.diagnosis.granted = granted_quantities(*signals, work.explanation, work.torque_gains);
    work.diagnosis.unexplained = unnamed_dependences(*signals, work.measured, work.explanation);
    add_rest(work.diagnosis.unexplained,
             unexplained_rest(*signals, work.measured, work.rest, work.explanation.noise));
    if (options.measure) {
        measure_on_held_out(work, how);
    } else {
        measure_from(work, 0, work.explanation);
    }
    return work;
}

} // namespace dfdyn::tools
