// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/textbook_findings.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/finding_gain.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double unlikely = 0.49;

/// Plain least squares of one output, in the order of `TextbookTerm`.
struct OutputFit {
    MatrixXd columns; ///< T x 5
    VectorXd values;
    MatrixXd covariance;
    bool another_gain = false; ///< the rigid body's factor cannot be 1
};

/// Returns the gradient of the fit's error, summed over each second.
MatrixXd seconds_of(const MatrixXd& columns, const VectorXd& error, const VectorXd& time_s) {
    std::vector<VectorXd> sums;
    double end_s = -std::numeric_limits<double>::infinity();
    for (Index row = 0; row < error.size(); ++row) {
        if (time_s[row] >= end_s) {
            end_s = time_s[row] + 1;
            sums.emplace_back(VectorXd::Zero(columns.cols()));
        }
        sums.back() += error[row] * columns.row(row).transpose();
    }
    MatrixXd result(columns.cols(), std::ssize(sums));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        result.col(static_cast<Index>(i)) = sums[i];
    }
    return result;
}

/// Takes into account that the rigid body's factor is near 1, unless the data contradict it.
void expect_gain_of_one(OutputFit& fit) {
    constexpr double deviation = 0.03; // of torque constants and masses that are given
    constexpr double far = 3;
    const double variance = fit.covariance(0, 0) + deviation * deviation;
    const double apart = 1 - fit.values[0];
    fit.another_gain = apart * apart > far * far * variance;
    if (!fit.another_gain) {
        const VectorXd along = fit.covariance.col(0) / variance;
        fit.values += apart * along;
        fit.covariance -= (variance * along * along.transpose()).eval();
    }
}

OutputFit fit_output(const DiagnosisWork& work, Index output, bool gains_known) {
    constexpr double damping = 1e-8; // columns may be combinations of each other
    const DiagnosisSignals& signals = *work.signals;
    OutputFit fit{textbook_columns(signals, signals.nominal.col(output), output), {}, {}};
    VectorXd weight = VectorXd::Ones(signals.rows());
    if (signals.measured.weight.size() > 0) {
        weight = signals.measured.weight.col(output);
    }
    const VectorXd norm = fit.columns.colwise().norm();
    const VectorXd scale = (norm.array() > 0).select(norm.cwiseInverse(), 0);
    const MatrixXd scaled = fit.columns * scale.asDiagonal();
    const MatrixXd weighed = weight.asDiagonal() * scaled;
    const Index count = scaled.cols();
    const MatrixXd inverse =
        solve_symmetric(MatrixXd(scaled.transpose() * weighed + damping * MatrixXd::Identity(count, count)),
                        MatrixXd(MatrixXd::Identity(count, count)));
    const VectorXd values = inverse * (weighed.transpose() * work.measured.col(output));
    const MatrixXd gradient =
        inverse * seconds_of(weighed, work.measured.col(output) - scaled * values, signals.measured.time_s);
    fit.values = scale.asDiagonal() * values;
    fit.covariance = scale.asDiagonal() * (gradient * gradient.transpose()).eval() * scale.asDiagonal();
    if (gains_known) {
        expect_gain_of_one(fit);
    }
    return fit;
}

/// Relative deviation of a parameter from one recording of an arm to the next. Viscous friction depends on
/// the lubricant's temperature. Chosen with the thirteen recordings of tests/data/ur5_kufieta.
double between_recordings(TextbookTerm term) { return term == TextbookTerm::viscous ? 0.15 : 0.05; }

/// Returns the finding of a term; its confidence is below 0.5 where the data do not support it.
Finding finding_of(const DiagnosisWork& work, const Effect& effect, const OutputFit& fit, Index output) {
    constexpr double price = 8; // log-evidence: one of a hundred causes with one coefficient
    const auto term = static_cast<Index>(*effect.textbook);
    const double value = fit.values[term];
    const double deviation = std::sqrt(fit.covariance(term, term));
    const double reach = std::hypot(reach_of_95(deviation, value),
                                    deviations_of_95 * between_recordings(*effect.textbook) * value);
    const ParameterKind& kind = effect.parameters.front();
    Finding finding;
    finding.effect = effect.name;
    finding.where = numbered("joint", static_cast<std::size_t>(output));
    finding.parameters = {{kind.name, kind.unit, value, value - reach, value + reach}};
    finding.margin_to_nothing = 0.5 * (value / deviation) * (value / deviation) - price;
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    finding.confidence = calibrated_confidence(finding, static_cast<double>(work.signals->rows()) /
                                                            work.signals->measured.rate_hz);
    finding.confirm = finding.where + ": " + effect.experiment;
    return finding;
}

bool possible(const Effect& effect, double value) {
    return effect.textbook == TextbookTerm::offset || value > 0;
}

/// Replaces the findings at a joint by those of plain least squares.
void replace_findings(DiagnosisWork& work, const OutputFit& fit, Index output, const Gains& gains) {
    std::vector<Finding>& findings = work.diagnosis.findings;
    const std::string joint = numbered("joint", static_cast<std::size_t>(output));
    const std::string actuator = numbered("actuator", static_cast<std::size_t>(output));
    std::erase_if(findings, [&](const Finding& one) {
        return one.where == joint && effect_named(one.effect).textbook.has_value();
    });
    for (Finding& one : findings) {
        const bool there = one.where == joint || (one.where == actuator && !fit.another_gain);
        if (there && !has_trait(one.effect, &Effect::interval)) {
            one.confidence = std::min(one.confidence, unlikely);
        }
    }
    for (const Effect& effect : effect_catalogue()) {
        if (!effect.textbook || !possible(effect, fit.values[static_cast<Index>(*effect.textbook)])) {
            continue;
        }
        Finding finding = finding_of(work, effect, fit, output);
        MatrixXd share = MatrixXd::Zero(work.signals->rows(), work.signals->outputs());
        const auto term = static_cast<Index>(*effect.textbook);
        share.col(output) = fit.values[term] * fit.columns.col(term);
        if (finding.margin_to_nothing > 0 && gains.tell(finding, share)) {
            findings.push_back(std::move(finding));
        }
    }
}

} // namespace

void name_by_least_squares(DiagnosisWork& work, bool gains_known) {
    const DiagnosisSignals& signals = *work.signals;
    Diagnosis& diagnosis = work.diagnosis;
    diagnosis.textbook = MatrixXd::Zero(5, signals.outputs());
    work.extended = signals.nominal + work.explanation.model(signals);
    std::vector<std::pair<Index, OutputFit>> better;
    for (Index output = 0; output < signals.outputs(); ++output) {
        OutputFit fit = fit_output(work, output, gains_known);
        diagnosis.textbook.col(output) = fit.values;
        if (diagnosis.by_least_squares[static_cast<std::size_t>(output)]) {
            work.extended.col(output) = fit.columns * fit.values;
            work.rest.col(output) = work.measured.col(output) - work.extended.col(output);
            better.emplace_back(output, std::move(fit));
        }
    }
    for (const StandingContact& push : work.pushes) {
        if (diagnosis.by_least_squares[push.joint]) {
            work.rest.col(static_cast<Index>(push.joint)) -= push.share;
        }
    }
    const Gains gains(signals, work.rest, diagnosis.output_names);
    for (const auto& [output, fit] : better) {
        if (!signals.wrench() && !signals.hardly_moves(static_cast<std::size_t>(output))) {
            replace_findings(work, fit, output, gains);
        }
    }
    sort_by_gain(diagnosis.findings);
}

} // namespace dfdyn::tools
