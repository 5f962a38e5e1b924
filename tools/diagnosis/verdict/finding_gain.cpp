// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/finding_gain.hpp"

#include "tools/base/numerics/root_mean_square.hpp"
#include "tools/base/text/number.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"

namespace dfdyn::tools {

namespace {

Eigen::MatrixXd slow_part(const DiagnosisSignals& signals, const Eigen::MatrixXd& series) {
    Eigen::MatrixXd result(series.rows(), series.cols());
    for (Eigen::Index output = 0; output < series.cols(); ++output) {
        result.col(output) = signals.below(gains_below_hz, series.col(output));
    }
    return result;
}

/// Determines the output with the largest effect relative to its noise, and the errors with and without the
/// effect.
void measure_gain(Finding& finding, const Eigen::MatrixXd& contribution, const Eigen::MatrixXd& rest) {
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

Gains::Gains(const DiagnosisSignals& signals, const Eigen::MatrixXd& rest,
             const std::vector<std::string>& output_names)
    : signals_(signals), output_names_(output_names), rest_(rest), slow_rest_(slow_part(signals, rest)) {}

bool Gains::tell(Finding& finding, const Eigen::MatrixXd& contribution) const {
    measure_gain(finding, slow_part(signals_, contribution), slow_rest_);
    std::string band = " below " + rounded_text(gains_below_hz) + " Hz";
    if (!(finding.rms_after < finding.rms_before)) {
        measure_gain(finding, contribution, rest_);
        band.clear();
    }
    finding.share = contribution.col(finding.output);
    finding.rest = rest_.col(finding.output);
    const auto output = static_cast<std::size_t>(finding.output);
    const bool falls = finding.rms_after < finding.rms_before;
    finding.evidence = "the error of " + output_names_[output] + " " + effect_named(finding.effect).evidence +
                       ": with it the error" + band + (falls ? " falls" : " rises") + " from " +
                       rounded_text(finding.rms_before) + " to " + rounded_text(finding.rms_after) + " " +
                       torque_unit(signals_.robot, signals_.wrench(), output);
    return falls;
}

} // namespace dfdyn::tools
