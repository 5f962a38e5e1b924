// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/diagnosis.hpp"

#include "tools/common/root_mean_square.hpp"
#include "tools/diagnosis/findings.hpp"
#include "tools/diagnosis/granted.hpp"
#include "tools/diagnosis/plausibility.hpp"
#include "tools/diagnosis/unexplained.hpp"
#include "tools/physics/torque_constants.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double fitted_share = 2.0 / 3; ///< of the time, for the figures on held-out time

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

ErrorMeasure error_measure(const Eigen::MatrixXd& error, const Eigen::MatrixXd& measured) {
    ErrorMeasure result{Eigen::VectorXd(error.cols()), Eigen::VectorXd(error.cols())};
    for (Eigen::Index output = 0; output < error.cols(); ++output) {
        const Eigen::VectorXd centred = measured.col(output).array() - measured.col(output).mean();
        result.rms[output] = root_mean_square(error.col(output));
        result.nrmse[output] = result.rms[output] / root_mean_square(centred);
    }
    return result;
}

/// Said where causes that were chosen on the first part of a recording do harm on the last.
void suspect_poor_extension(Diagnosis& diagnosis) {
    std::string worse;
    for (Eigen::Index output = 0; output < diagnosis.nominal.rms.size(); ++output) {
        if (diagnosis.extended.rms[output] > diagnosis.nominal.rms[output]) {
            worse.append(worse.empty() ? "" : ", ")
                .append(diagnosis.output_names[static_cast<std::size_t>(output)]);
        }
    }
    if (!worse.empty()) {
        diagnosis.suspicions.push_back(
            "on held-out time the extended model errs more than the nominal one at " + worse +
            ": this recording is too short, or too little like itself, for these causes");
    }
}

/// Errors from `first` on, without the causes of an explanation and with them.
void measure_from(DiagnosisWork& work, Eigen::Index first, const Explanation& explanation) {
    const DiagnosisSignals& signals = *work.signals;
    const Eigen::Index count = signals.rows() - first;
    const Eigen::MatrixXd nominal_error = work.measured - signals.nominal;
    const Eigen::MatrixXd scaled = work.measured.bottomRows(count) * work.torque_gains.asDiagonal();
    const auto measure = [&](const Eigen::MatrixXd& error) {
        return error_measure(error.bottomRows(count) * work.torque_gains.asDiagonal(), scaled);
    };
    work.diagnosis.nominal = measure(nominal_error);
    work.diagnosis.extended = measure(nominal_error - explanation.model(signals));
}

/// Errors on the last third, of a model that was chosen and fitted without it.
void measure_on_held_out(DiagnosisWork& work, ExplanationOptions options) {
    options.fitted_share = fitted_share;
    const DiagnosisSignals& signals = *work.signals;
    const Eigen::Index first = std::llround(fitted_share * static_cast<double>(signals.rows()));
    measure_from(work, first, explain(signals, work.measured, options));
    Diagnosis& diagnosis = work.diagnosis;
    suspect_poor_extension(diagnosis);
    diagnosis.heldout_from_s = signals.measured.time_s[first];
    diagnosis.heldout_to_s = signals.measured.time_s[signals.rows() - 1];
}

} // namespace

DiagnosisWork diagnose(const Robot& robot, const Recording& recording, const DiagnosisOptions& options) {
    DiagnosisWork work;
    work.diagnosis.output_names = recording.output.names;
    Suspicions suspicions = suspicions_of_file(robot, recording);
    work.diagnosis.suspicions = std::move(suspicions.sentences);
    if (suspicions.fatal) {
        return work;
    }
    auto signals = std::make_shared<DiagnosisSignals>(
        diagnosis_signals(robot, options.outputs, measured_motion(recording)));
    work.signals = signals;
    work.torque_gains = torque_gains(*signals, options);
    work.measured = signals->measured.outputs * work.torque_gains.cwiseInverse().asDiagonal();
    const bool gains_known =
        options.outputs != OutputKind::motor_current || !options.torque_constants.empty();
    suspicions = suspicions_of_motion(*signals, work.measured, gains_known);
    work.diagnosis.suspicions.insert(work.diagnosis.suspicions.end(), suspicions.sentences.begin(),
                                     suspicions.sentences.end());
    if (suspicions.fatal) {
        measure_from(work, 0, work.explanation); // without causes
        return work;
    }
    ExplanationOptions how{gains_known, 1, options.progress};
    work.explanation = explain(*signals, work.measured, how);
    work.rest = work.measured - signals->nominal - work.explanation.all(*signals);
    const std::vector<StandingContact> pushes = standing_contacts(*signals, work.explanation, work.rest);
    for (const StandingContact& push : pushes) {
        work.rest.col(static_cast<Eigen::Index>(push.joint)) -= push.share;
    }
    work.diagnosis.findings =
        findings_of(*signals, work.explanation, pushes, work.rest, work.diagnosis.output_names);
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
