// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"
#include "tools/diagnosis/search/stationary_contacts.hpp"
#include "tools/diagnosis/signals/raw_samples.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A parameter with its 95 % interval.
struct FoundParameter {
    std::string name, unit;
    double value = 0, low = 0, high = 0;
};

struct OtherCause {
    std::string effect, where, why_not;
};

/// A reason why a recording may be unsuitable.
struct Suspicion {
    std::string text;       ///< one sentence
    std::string code = {};  ///< as in `refusals` of diagnosis.json if it refuses the recording; else empty
    std::string where = {}; ///< with a code: names of the affected columns
    std::string recording = {}; ///< the affected one of several recordings; empty: all

    /// Returns the sentence after the recording's name.
    std::string words() const { return recording.empty() ? text : recording + ": " + text; }
};

/// Upper frequency limit for the error that a cause reduces.
inline constexpr double reduction_below_hz = 5;
/// Share of rows in standstill above which errors are also reported without these rows.
inline constexpr double noticeable_standstill = 0.02;

/// A parameter in one of several recordings, with its 95 % interval.
struct ValueOfRecording {
    std::string recording; ///< name of the file
    double value = 0, low = 0, high = 0;
};

/// A cause from the catalogue, identified at a place.
struct Finding {
    std::string effect, where, detail;
    std::vector<FoundParameter> parameters; ///< the main one first
    double confidence = 0;   ///< calibrated probability that this cause is present at this place
    Eigen::Index output = 0; ///< on which its effect is largest
    /// of the low-frequency error of this output, without and with the effect
    double rms_before = 0, rms_after = 0;
    Eigen::VectorXd share; ///< T: contribution to this output
    Eigen::VectorXd rest;  ///< T: residual of this output after all causes of the same fit
    std::string evidence;
    std::vector<OtherCause> indistinguishable, alternatives;
    std::string confirm;
    double margin_to_nothing = 0, margin_to_others = 0; ///< log-odds behind the confidence
    /// With several recordings: the main parameter in each, if fitted, and its standard deviation between
    /// them.
    std::vector<ValueOfRecording> by_recording = {};
    double spread = 0;
    std::string only_in = {}; ///< the only recording with this cause; empty: all have it
};

/// A nuisance parameter with its estimate. It is not a finding.
struct NuisanceEstimate {
    std::string where;
    FoundParameter parameter;    ///< `mass`, or `torque_constant`
    std::optional<double> given; ///< value in the robot's file
};

/// A predictable part of the error that no effect of the catalogue explains.
struct Unexplained {
    Eigen::Index output = 0;
    double nrmse = 0; ///< of the predictable part, relative to the output's standard deviation
    std::vector<std::string> depends_on;
    std::string note;
};

struct ErrorMeasure {
    Eigen::VectorXd rms, nrmse; ///< per output
    /// As `nrmse`, without the rows in which the output's joint is stationary and static friction determines
    /// its torque (`joint_row_weight`). NaN if no other rows exist.
    Eigen::VectorXd moving_nrmse;
};

/// Result of comparing a recording with a robot's model. Interfaces: diagnosis.json.
struct Diagnosis {
    std::vector<std::string> output_names;
    std::vector<std::string> output_units; ///< as measured: A, N·m or N
    std::vector<std::string> torque_units; ///< of the causes' contributions to the outputs: N·m or N
    std::vector<Suspicion> suspicions;
    std::string scope = "the whole recording"; ///< rows that were diagnosed
    /// Errors of the samples as measured, on the held-out time, or over the whole recording if there is none.
    ErrorMeasure nominal, extended;
    ErrorMeasure causes;        ///< of the causes found, also where plain least squares replaces them
    ErrorMeasure least_squares; ///< of plain least squares for each output (`textbook_fit`)
    /// 5 x m: plain least squares of the moving rows of the whole recording (`fit_moving_rows`)
    Eigen::MatrixXd textbook;
    /// Per output: plain least squares is the extended model, because its error is smaller than that of the
    /// causes.
    std::vector<bool> by_least_squares;
    Eigen::VectorXd standstill_share; ///< m: share of these rows that `moving_nrmse` excludes
    double heldout_from_s = 0, heldout_to_s = 0;
    std::vector<std::string> recordings; ///< names of several that were fitted together; else empty
    std::vector<Finding> findings;       ///< in descending order of error reduction
    std::vector<NuisanceEstimate> nuisance_estimates;
    std::vector<Unexplained> unexplained;
};

/// Returns whether one of the suspicions refuses a recording.
inline bool any_refusal(const std::vector<Suspicion>& suspicions) {
    return std::ranges::any_of(suspicions,
                               [](const Suspicion& suspicion) { return !suspicion.code.empty(); });
}

/// Returns whether no cause is named, because the set-up is wrong or the recording is unsuitable.
inline bool refused(const Diagnosis& diagnosis) { return any_refusal(diagnosis.suspicions); }

/// Returns whether part of the recording was held out, so that the errors are measured there.
inline bool has_held_out(const Diagnosis& diagnosis) {
    return diagnosis.heldout_to_s > diagnosis.heldout_from_s;
}

struct DiagnosisOptions {
    OutputKind outputs = OutputKind::joint_torque;
    std::vector<double> torque_constants; ///< N·m/A per joint; empty: unknown, each joint has its own gain
    /// Measured unit per N·m of currents, from the fit of several recordings; empty: from the constants or
    /// the recording.
    Eigen::VectorXd torque_gains = {};
    bool measure = true; ///< whether to measure the held-out error, which doubles the run time
    /// Recordings that are joined in the diagnosed one, whose set-ups are checked; empty: it is a single one.
    std::span<const Recording> parts = {};
    bool check_setup = true; ///< false: continues even if units, clock, columns or signs look wrong
    std::optional<std::vector<Suspicion>> setup = {}; ///< findings of the set-up check, if it was done
    std::function<void(int round)> progress = {};
    std::span<const Effect> effects = effect_catalogue(); ///< that can be named
};

/// All intermediate results of a diagnosis, for the report and the extended model.
struct DiagnosisWork {
    std::shared_ptr<const DiagnosisSignals> signals; ///< null if the recording is unsuitable
    Eigen::MatrixXd measured;                        ///< T x m, as torques if currents were measured
    Eigen::VectorXd torque_gains; ///< per output: measured unit per N·m (N); 1 except for currents
    FittedEffects fitted_effects;
    std::vector<StationaryContact> pushes; ///< at stationary joints
    RawSamples samples;                    ///< of the recording; without rows: errors are those of `measured`
    Eigen::MatrixXd rest; ///< T x m: residual after the fitted effects and the contacts, as `measured`
    Diagnosis diagnosis;
    /// T x m: outputs of the extended model of the whole recording, as `measured`; at outputs where plain
    /// least squares is better, those of plain least squares
    Eigen::MatrixXd extended = {};
    bool gains_known = true; ///< torques were measured, or the torque constants of currents are given
};

/// Returns whether effects were fitted, so that an extended model can be made: the recording is suitable.
inline bool effects_fitted(const DiagnosisWork& work) {
    return work.signals != nullptr && !work.fitted_effects.candidates.empty();
}

/// Returns the measured unit per N·m (N) of each output: 1 except for currents, whose torque constants are
/// given or estimated, unless the options have such gains.
Eigen::VectorXd torque_gains(const DiagnosisSignals& signals, const DiagnosisOptions& options);

/// Checks the set-up of the recording, or of several `options.parts` instead. Returns the suspicions, those
/// that refuse a recording first.
std::vector<Suspicion> suspicions_of_setup(const Robot& robot, const Recording& recording,
                                           const DiagnosisOptions& options);

/// Diagnoses a recording. Throws InputError if the recording is too short or does not match the robot.
DiagnosisWork diagnose(const Robot& robot, const Recording& recording, const DiagnosisOptions& options);

} // namespace dfdyn::tools
