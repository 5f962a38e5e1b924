// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/error_reduction.hpp"

#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/base/text/number.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"

namespace dfdyn::tools {

namespace {

Eigen::MatrixXd slow_part(const DiagnosisSignals& signals, const Eigen::MatrixXd& series) {
    Eigen::MatrixXd result(series.rows(), series.cols());
    for (Eigen::Index output = 0; output < series.cols(); ++output) {
        result.col(output) = signals.below(reduction_below_hz, series.col(output));
    }
    return result;
}

/// Determines the output with the largest effect relative to its noise, and the errors with and without the
/// effect.
void measure_reduction(Finding& finding, const Eigen::MatrixXd& contribution, const Eigen::MatrixXd& rest) {
    double largest = -1;
    for (Eigen::Index output = 0; output < rest.cols(); ++output) {
        const double ratio = root_mean_square(contribution.col(output)) / root_mean_square(rest.col(output));
        if (ratio > largest) {
            largest = ratio;
            finding.output = output;
        }
    }
    finding.rms_after = root_mean_square(rest.col(finding.output));
    finding.rms_before = root_mean_square(rest.col(finding.output) + contribution.col(finding.output));
}

} // namespace

ErrorReduction::ErrorReduction(const DiagnosisSignals& signals, const Eigen::MatrixXd& rest,
                               const std::vector<std::string>& output_names)
    : signals_(signals), output_names_(output_names), rest_(rest), slow_rest_(slow_part(signals, rest)) {}

void ErrorReduction::describe(Finding& finding, const Eigen::MatrixXd& contribution) const {
    measure_reduction(finding, slow_part(signals_, contribution), slow_rest_);
    std::string band = " below " + rounded_text(reduction_below_hz) + " Hz";
    if (!reduces_error(finding)) {
        measure_reduction(finding, contribution, rest_);
        band.clear();
    }
    finding.share = contribution.col(finding.output);
    finding.rest = rest_.col(finding.output);
    finding.evidence = evidence_text(finding, band);
}

/// Returns `the error of tau2 grows with the velocity: with it the error below 5 Hz falls from 2 to 1 N·m`.
std::string ErrorReduction::evidence_text(const Finding& finding, const std::string& band) const {
    const auto output = static_cast<std::size_t>(finding.output);
    return "the error of " + output_names_[output] + " " + effect_named(finding.effect).evidence +
           ": with it the error" + band + (reduces_error(finding) ? " falls" : " rises") + " from " +
           rounded_text(finding.rms_before) + " to " + rounded_text(finding.rms_after) + " " +
           torque_unit(signals_.robot, signals_.wrench(), output);
}

bool reduces_error(const Finding& finding) { return finding.rms_after < finding.rms_before; }

} // namespace dfdyn::tools
