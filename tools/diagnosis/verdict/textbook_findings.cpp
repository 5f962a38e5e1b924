// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/textbook_findings.hpp"

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

/// Relative deviation of a parameter from one recording of an arm to the next. Viscous friction depends on
/// the lubricant's temperature. Chosen with the thirteen recordings of tests/data/ur5_kufieta.
double between_recordings(TextbookTerm term) { return term == TextbookTerm::viscous ? 0.15 : 0.05; }

/// Returns the finding of a term; its confidence is below 0.5 where the data do not support it.
Finding finding_of(const DiagnosisWork& work, const Effect& effect, const MovingFit& fit, Index output) {
    constexpr double price = 8; // least log-evidence of a cause with one coefficient in the panel's search
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
    finding.margin_to_nothing = 0.5 * std::pow(value / std::max(deviation, 1e-12), 2) - price;
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    finding.confidence = calibrated_confidence(finding, static_cast<double>(work.signals->rows()) /
                                                            work.signals->measured.rate_hz);
    finding.confirm = confirmation(finding);
    return finding;
}

bool physically_possible(const Effect& effect, double value) {
    return effect.textbook == TextbookTerm::offset || value > 0;
}

/// Returns the findings of plain least squares at an output's joint.
std::vector<Finding> findings_at(const DiagnosisWork& work, const MovingFit& fit, Index output,
                                 const Gains& gains) {
    std::vector<Finding> findings;
    for (const Effect& effect : effect_catalogue()) {
        if (!effect.textbook ||
            !physically_possible(effect, fit.values[static_cast<Index>(*effect.textbook)])) {
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
    return findings;
}

/// Adds the findings of plain least squares at a joint. Removes those that they replace, and doubts the
/// others there.
void replace_findings(std::vector<Finding>& findings, std::vector<Finding> better, const std::string& joint,
                      const std::string& actuator, bool another_gain) {
    std::erase_if(findings, [&](const Finding& one) {
        return one.where == joint && std::ranges::find(better, one.effect, &Finding::effect) != better.end();
    });
    for (Finding& one : findings) {
        const bool gain = one.effect == effects::actuator_gain().name && another_gain;
        const bool there = one.where == joint || (one.where == actuator && !gain);
        if (there && !has_trait(one.effect, &Effect::interval)) {
            one.confidence = std::min(one.confidence, unlikely);
        }
    }
    std::ranges::move(better, std::back_inserter(findings));
}

} // namespace

void name_by_least_squares(DiagnosisWork& work) {
    constexpr Index fewest_blocks = 10; // twice the coefficients
    const DiagnosisSignals& signals = *work.signals;
    Diagnosis& diagnosis = work.diagnosis;
    diagnosis.textbook = MatrixXd::Zero(5, signals.outputs());
    work.extended = signals.nominal + work.fitted_effects.model(signals);
    const MatrixXd all_rows =
        textbook_fit(signals, work.measured, signals.nominal, signals.rows()).prediction;
    MatrixXd left = work.measured; // least squares and pushes will be taken off
    std::vector<std::pair<Index, MovingFit>> better;
    for (Index output = 0; output < signals.outputs(); ++output) {
        const auto number = static_cast<std::size_t>(output);
        MovingFit fit = fit_moving_rows(signals, work.measured.col(output), signals.nominal.col(output),
                                        output, work.gains_known);
        diagnosis.textbook.col(output) = fit.values;
        left.col(output) -= fit.columns * fit.values;
        if (diagnosis.by_least_squares[number]) {
            work.extended.col(output) = all_rows.col(output);
            if (!signals.wrench() && !signals.hardly_moves(number) && fit.blocks >= fewest_blocks) {
                better.emplace_back(output, std::move(fit));
            }
        }
    }
    for (const StationaryContact& push : work.pushes) {
        left.col(static_cast<Index>(push.joint)) -= push.share;
    }
    const Gains gains(signals, left, diagnosis.output_names);
    for (const auto& [output, fit] : better) {
        const auto number = static_cast<std::size_t>(output);
        replace_findings(diagnosis.findings, findings_at(work, fit, output, gains), numbered("joint", number),
                         numbered("actuator", number), fit.another_gain);
    }
    sort_by_gain(diagnosis.findings);
}

} // namespace dfdyn::tools
