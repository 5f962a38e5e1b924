// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/extension_errors.hpp"

#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/base/text/number.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

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
        const double deviation = standard_deviation(measured.col(output));
        result.nrmse[output] =
            deviation > 0 ? result.rms[output] / deviation : std::numeric_limits<double>::quiet_NaN();
        const std::vector<Eigen::Index>& rows = moving[static_cast<std::size_t>(output)];
        result.moving_nrmse[output] =
            std::ssize(rows) < fewest_moving
                ? std::numeric_limits<double>::quiet_NaN()
                : root_mean_square(error(rows, output)) / standard_deviation(measured(rows, output));
    }
    return result;
}

/// Returns, per output, the samples from `first` on, as indices from there, whose torque is not determined by
/// static friction.
std::vector<std::vector<Eigen::Index>> moving_samples(const DiagnosisSignals& signals,
                                                      const RawSamples& samples, Eigen::Index first) {
    std::vector<std::vector<Eigen::Index>> result;
    for (Eigen::Index output = 0; output < signals.outputs(); ++output) {
        result.emplace_back();
        for (Eigen::Index sample = first; sample < samples.outputs.rows(); ++sample) {
            if (signals.measured.weight(samples.nearest(sample), output) > 0) {
                result.back().push_back(sample - first);
            }
        }
    }
    return result;
}

void take(ErrorMeasure& measure, const ErrorMeasure& other, Eigen::Index output) {
    measure.rms[output] = other.rms[output];
    measure.nrmse[output] = other.nrmse[output];
    measure.moving_nrmse[output] = other.moving_nrmse[output];
}

/// Replaces the causes by plain least squares at the outputs where its error is smaller.
void take_better(Diagnosis& diagnosis) {
    constexpr double tolerance = 1.03;
    std::string names;
    for (Eigen::Index output = 0; output < diagnosis.extended.rms.size(); ++output) {
        const bool better = diagnosis.extended.rms[output] > tolerance * diagnosis.least_squares.rms[output];
        diagnosis.by_least_squares[static_cast<std::size_t>(output)] = better;
        if (better) {
            take(diagnosis.extended, diagnosis.least_squares, output);
            names.append(names.empty() ? "" : ", ")
                .append(diagnosis.output_names[static_cast<std::size_t>(output)]);
        }
    }
    if (!names.empty()) {
        diagnosis.suspicions.push_back(
            {"at " + names +
             " the causes found err more than plain least squares per joint "
             "(gain, inertia, viscous and dry friction, offset), which replaces them in the extended model"});
    }
}

/// Returns a reason at the joint why the extended model can have a larger error at an output than the nominal
/// one; empty if there is none.
std::string reason_of_harm(const Diagnosis& diagnosis, Eigen::Index output) {
    constexpr double clear_fall = 0.9;
    const double nominal = diagnosis.nominal.moving_nrmse[output];
    const double extended = diagnosis.extended.moving_nrmse[output];
    if (std::isnan(nominal)) {
        return "where the joint is stationary all of that time, so that static friction may hold any torque";
    }
    if (extended < clear_fall * nominal) {
        return "although the error during motion decreases from " + percent(nominal) + " to " +
               percent(extended) + ": at standstill, static friction may hold any torque";
    }
    return "";
}

/// Adds a suspicion if causes from the first part of a recording increase the error on the last part.
void suspect_poor_extension(Diagnosis& diagnosis) {
    const std::string lead =
        "on held-out time the extended model has a larger error than the nominal one at ";
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
            {lead + worse + ": for these causes the recording is too short, or its parts differ too much"});
    }
}

} // namespace

void measure_from(DiagnosisWork& work, Eigen::Index first, const FittedEffects& fitted_effects) {
    const DiagnosisSignals& signals = *work.signals;
    const auto in_output_units = [&](const Eigen::MatrixXd& torques) -> Eigen::MatrixXd {
        return torques * work.torque_gains.asDiagonal();
    };
    if (work.samples.outputs.rows() == 0) {
        work.samples = own_samples(signals.measured, in_output_units(work.measured));
    }
    const RawSamples& samples = work.samples;
    const Eigen::Index begin = samples.before(first);
    const Eigen::Index count = samples.outputs.rows() - begin;
    const Eigen::MatrixXd outputs = samples.outputs.bottomRows(count);
    const std::vector<std::vector<Eigen::Index>> moving = moving_samples(signals, samples, begin);
    const auto measure = [&](const Eigen::MatrixXd& prediction) {
        return error_measure(outputs - samples.at(in_output_units(prediction)).bottomRows(count), outputs,
                             moving);
    };
    Diagnosis& diagnosis = work.diagnosis;
    diagnosis.standstill_share.resize(signals.outputs());
    std::ranges::transform(moving, diagnosis.standstill_share.begin(), [count](const auto& rows) {
        return 1 - static_cast<double>(rows.size()) / static_cast<double>(count);
    });
    const Eigen::Index fitted = first > 0 ? first : signals.rows();
    diagnosis.nominal = measure(signals.nominal);
    diagnosis.causes = measure(signals.nominal + fitted_effects.reported_contribution(signals));
    diagnosis.extended = diagnosis.causes;
    diagnosis.least_squares =
        measure(textbook_fit(signals, work.measured, signals.nominal, fitted).prediction);
    diagnosis.by_least_squares.assign(static_cast<std::size_t>(signals.outputs()), false);
    if (!fitted_effects.candidates.empty()) {
        take_better(diagnosis);
    }
}

void measure_on_held_out(DiagnosisWork& work, FitOptions options) {
    options.fitted_share = fitted_share;
    const DiagnosisSignals& signals = *work.signals;
    const Eigen::Index first = std::llround(fitted_share * static_cast<double>(signals.rows()));
    measure_from(work, first, find_effects(signals, work.measured, options));
    Diagnosis& diagnosis = work.diagnosis;
    suspect_poor_extension(diagnosis);
    diagnosis.heldout_from_s = signals.measured.time_s[first];
    diagnosis.heldout_to_s = signals.measured.time_s[signals.rows() - 1];
}

} // namespace dfdyn::tools
