// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/extension_errors.hpp"

#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/base/text/number.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr double fitted_share = 2.0 / 3; ///< of the time; the rest is held out

constexpr Eigen::Index fewest_moving = 50; ///< minimum number of rows for an error during motion

double standard_deviation(const Eigen::VectorXd& values) {
    return root_mean_square((values.array() - values.mean()).matrix());
}

/// `moving`: per output, the rows for the error during motion.
ErrorMeasure error_measure(const Eigen::MatrixXd& error, const Eigen::MatrixXd& measured,
                           const std::vector<std::vector<Eigen::Index>>& moving) {
    ErrorMeasure result{Eigen::VectorXd(error.cols()), Eigen::VectorXd(error.cols()),
                        Eigen::VectorXd(error.cols())};
    for (Eigen::Index output = 0; output < error.cols(); ++output) {
        result.rms[output] = root_mean_square(error.col(output));
        result.nrmse[output] = result.rms[output] / standard_deviation(measured.col(output));
        const std::vector<Eigen::Index>& rows = moving[static_cast<std::size_t>(output)];
        result.moving_nrmse[output] =
            std::ssize(rows) < fewest_moving
                ? std::numeric_limits<double>::quiet_NaN()
                : root_mean_square(error(rows, output)) / standard_deviation(measured(rows, output));
    }
    return result;
}

/// Returns, per output, the rows among the last `count` in which static friction does not determine the
/// torque.
std::vector<std::vector<Eigen::Index>> moving_rows(const DiagnosisSignals& signals, Eigen::Index count) {
    std::vector<std::vector<Eigen::Index>> result;
    const auto weight = signals.measured.weight.bottomRows(count);
    for (Eigen::Index output = 0; output < weight.cols(); ++output) {
        result.emplace_back();
        for (Eigen::Index row = 0; row < count; ++row) {
            if (weight(row, output) > 0) {
                result.back().push_back(row);
            }
        }
    }
    return result;
}

/// Returns a reason at the joint why the extended model can have a larger error at an output than the nominal
/// one; empty if there is none.
std::string reason_of_harm(const Diagnosis& diagnosis, Eigen::Index output) {
    constexpr double clear_fall = 0.9;
    const double nominal = diagnosis.nominal.moving_nrmse[output];
    const double extended = diagnosis.extended.moving_nrmse[output];
    if (std::isnan(nominal)) {
        return "where the joint stands all of that time, and its friction may hold whatever it was left with";
    }
    if (extended < clear_fall * nominal) {
        return "though while the joint moves the error falls from " + percent(nominal) + " to " +
               percent(extended) + ": standing, its friction may hold whatever it was left with";
    }
    return "";
}

/// Adds a suspicion if causes from the first part of a recording increase the error on the last part.
void suspect_poor_extension(Diagnosis& diagnosis) {
    const std::string lead = "on held-out time the extended model errs more than the nominal one at ";
    std::string worse;
    for (Eigen::Index output = 0; output < diagnosis.nominal.rms.size(); ++output) {
        if (!(diagnosis.extended.rms[output] > diagnosis.nominal.rms[output])) {
            continue;
        }
        const std::string& name = diagnosis.output_names[static_cast<std::size_t>(output)];
        const std::string reason = reason_of_harm(diagnosis, output);
        if (reason.empty()) {
            worse.append(worse.empty() ? "" : ", ").append(name);
        } else {
            diagnosis.suspicions.push_back({std::string(lead).append(name).append(", ").append(reason)});
        }
    }
    if (!worse.empty()) {
        diagnosis.suspicions.push_back(
            {lead + worse + ": this recording is too short, or too little like itself, for these causes"});
    }
}

} // namespace

void measure_from(DiagnosisWork& work, Eigen::Index first, const Explanation& explanation) {
    const DiagnosisSignals& signals = *work.signals;
    const Eigen::Index count = signals.rows() - first;
    const Eigen::MatrixXd nominal_error = work.measured - signals.nominal;
    const Eigen::MatrixXd scaled = work.measured.bottomRows(count) * work.torque_gains.asDiagonal();
    const std::vector<std::vector<Eigen::Index>> moving = moving_rows(signals, count);
    const auto measure = [&](const Eigen::MatrixXd& error) {
        return error_measure(error.bottomRows(count) * work.torque_gains.asDiagonal(), scaled, moving);
    };
    work.diagnosis.standing_share.resize(signals.outputs());
    std::ranges::transform(moving, work.diagnosis.standing_share.begin(), [count](const auto& rows) {
        return 1 - static_cast<double>(rows.size()) / static_cast<double>(count);
    });
    work.diagnosis.nominal = measure(nominal_error);
    work.diagnosis.extended = measure(nominal_error - explanation.model(signals));
}

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

} // namespace dfdyn::tools
