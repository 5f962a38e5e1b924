// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/search/explanation.hpp"
#include "tools/diagnosis/search/standing_contacts.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
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

/// What a cause brings is measured below it.
inline constexpr double gains_below_hz = 5;
/// Share of the rows in which a joint stands, from which on errors are told without them, too.
inline constexpr double noticeable_standing = 0.02;

/// A cause that is named.
struct Finding {
    std::string effect, where, detail;
    std::vector<FoundParameter> parameters; ///< the main one first
    double confidence = 0;                  ///< calibrated probability that this cause at this place is there
    Eigen::Index output = 0;                ///< where it shows most
    double rms_before = 0, rms_after = 0;   ///< of the slow error there, without and with it
    Eigen::VectorXd share;                  ///< T: what it adds there
    std::string evidence;
    std::vector<OtherCause> indistinguishable, alternatives;
    std::string confirm;
    double margin_to_nothing = 0, margin_to_others = 0; ///< logarithms of the odds behind the confidence
};

/// What the model has as it fits best, and is no finding.
struct GrantedQuantity {
    std::string where;
    FoundParameter parameter;    ///< `mass`, or `torque_constant`
    std::optional<double> given; ///< by the robot's file
};

/// What no name of the catalogue explains.
struct Unexplained {
    Eigen::Index output = 0;
    double nrmse = 0; ///< what could still be predicted, of the output's standard deviation
    std::vector<std::string> depends_on;
    std::string note;
};

struct ErrorMeasure {
    Eigen::VectorXd rms, nrmse; ///< per output
    /// The same as `nrmse` without the rows where the output's joint stands and its torque is whatever
    /// friction was left with (`joint_row_weight`); not a number where no others are left.
    Eigen::VectorXd moving_nrmse;
};

/// What a recording says of a robot's model. Interfaces: diagnosis.json.
struct Diagnosis {
    std::vector<std::string> output_names;
    std::vector<std::string> suspicions; ///< why the recording may not answer at all; a sentence each
    ErrorMeasure nominal, extended;      ///< on the held-out time; without one, over the whole recording
    Eigen::VectorXd standing_share; ///< m: of the rows behind these errors, those that `moving_nrmse` has not
    double heldout_from_s = 0, heldout_to_s = 0;
    std::vector<Finding> findings; ///< by gain
    std::vector<GrantedQuantity> granted;
    std::vector<Unexplained> unexplained;
};

struct DiagnosisOptions {
    OutputKind outputs = OutputKind::joint_torque;
    std::vector<double>
        torque_constants;    ///< N·m/A per joint; empty: unknown, each joint has a factor of its own
    bool measure = true;     ///< whether the held-out error is measured, which takes as long again
    bool check_setup = true; ///< false: goes on although units, clock, columns or signs look wrong
    std::function<void(int round)> progress = {};
};

/// Everything behind a diagnosis, for the report and the extended model.
struct DiagnosisWork {
    std::shared_ptr<const DiagnosisSignals> signals; ///< null where the recording could not be asked
    Eigen::MatrixXd measured;                        ///< T x m, as torques where currents were measured
    Eigen::VectorXd torque_gains; ///< per output: measured unit per N·m (N); 1 but for currents
    Explanation explanation;
    std::vector<StandingContact> pushes; ///< at joints that stood
    Eigen::MatrixXd rest;                ///< T x m: what neither that nor a push explains, as `measured`
    Diagnosis diagnosis;
};

/// Throws InputError when the recording is too short, or not of this robot.
DiagnosisWork diagnose(const Robot& robot, const Recording& recording, const DiagnosisOptions& options);

} // namespace dfdyn::tools
