// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/diagnosis.hpp"

#include "tools/base/text/text.hpp"
#include "tools/diagnosis/verdict/extension_errors.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"
#include "tools/diagnosis/verdict/nuisance_estimates.hpp"
#include "tools/diagnosis/verdict/plausibility.hpp"
#include "tools/diagnosis/verdict/textbook_findings.hpp"
#include "tools/diagnosis/verdict/unexplained.hpp"
#include "tools/robot/identification/torque_gains.hpp"
#include "tools/setup_check/setup_check.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Adds suspicions. Returns whether the diagnosis is refused.
bool suspect(Diagnosis& diagnosis, std::vector<Suspicion> suspicions) {
    std::ranges::move(suspicions, std::back_inserter(diagnosis.suspicions));
    return refused(diagnosis);
}

/// Finds the effects, and contacts during standstill in their residual.
void fit(DiagnosisWork& work, const FitOptions& how) {
    const DiagnosisSignals& signals = *work.signals;
    work.fitted_effects = find_effects(signals, work.measured, how);
    work.rest = work.measured - signals.nominal - work.fitted_effects.total_contribution(signals);
    work.pushes = stationary_contacts(signals, work.fitted_effects, work.measured, work.rest);
    for (const StationaryContact& push : work.pushes) {
        work.rest.col(static_cast<Eigen::Index>(push.joint)) -= push.share;
    }
}

} // namespace

Eigen::VectorXd torque_gains(const DiagnosisSignals& signals, const DiagnosisOptions& options) {
    if (options.outputs == OutputKind::motor_current && options.torque_gains.size() > 0) {
        return options.torque_gains;
    }
    const auto estimate = [&] {
        return rough_torque_gains(signals.robot, {signals.measured.motion, signals.measured.outputs},
                                  signals.sign_velocity.maxCoeff());
    };
    const std::vector<double> gains =
        output_gains(torque_gains(signals.robot, options.outputs, options.torque_constants, estimate),
                     static_cast<std::size_t>(signals.outputs()));
    return Eigen::Map<const Eigen::VectorXd>(gains.data(), signals.outputs());
}

std::vector<Suspicion> suspicions_of_setup(const Robot& robot, const Recording& recording,
                                           const DiagnosisOptions& options) {
    const bool several = options.parts.size() > 1;
    std::vector<Suspicion> suspicions;
    for (const Recording& part : several ? options.parts : std::span(&recording, 1)) {
        for (const SetupFinding& finding :
             check_setup(part, {options.outputs, &robot, options.torque_constants})) {
            const bool mistake = finding.severity == Severity::mistake;
            suspicions.push_back({finding.text, mistake ? std::string(name_of(finding.fault)) : "",
                                  mistake ? finding.columns : "", several ? shown(part.source) : ""});
        }
    }
    std::ranges::stable_sort(suspicions, {}, [](const Suspicion& one) { return one.code.empty(); });
    return suspicions;
}

DiagnosisWork diagnose(const Robot& robot, const Recording& recording, const DiagnosisOptions& options) {
    DiagnosisWork work;
    work.diagnosis.output_names = recording.output.names;
    set_output_units(work.diagnosis, robot, options.outputs);
    if (options.check_setup &&
        suspect(work.diagnosis,
                options.setup ? *options.setup : suspicions_of_setup(robot, recording, options))) {
        return work;
    }
    if (suspect(work.diagnosis, suspicions_of_file(recording))) {
        return work;
    }
    auto signals = std::make_shared<DiagnosisSignals>(
        diagnosis_signals(robot, options.outputs, measured_motion(recording)));
    work.signals = signals;
    work.samples = raw_samples(recording, signals->measured);
    work.torque_gains = torque_gains(*signals, options);
    work.measured = signals->measured.outputs * work.torque_gains.cwiseInverse().asDiagonal();
    work.gains_known = options.outputs != OutputKind::motor_current || !options.torque_constants.empty();
    if (suspect(work.diagnosis, suspicions_of_motion(*signals, work.measured, recording))) {
        measure_from(work, 0, work.fitted_effects); // without effects
        work.extended = signals->nominal;
        return work;
    }
    const FitOptions how{work.gains_known, 1, options.progress, options.effects};
    fit(work, how);
    work.diagnosis.findings =
        findings_of(*signals, work.fitted_effects, work.pushes, work.rest, work.diagnosis.output_names);
    if (options.measure) {
        measure_on_held_out(work, how);
    } else {
        measure_from(work, 0, work.fitted_effects);
    }
    name_by_least_squares(work);
    work.diagnosis.nuisance_estimates = estimate_nuisances(*signals, work.fitted_effects, work.torque_gains);
    use_units_of_joints(work.diagnosis, robot);
    set_unexplained(work);
    doubt_useless_findings(work.diagnosis);
    return work;
}

} // namespace dfdyn::tools
