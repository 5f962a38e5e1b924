// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/textbook_findings.hpp"

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/verdict/arm_fit.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Relative standard deviation of a parameter between recordings of an arm. Viscous friction depends on the
/// lubricant's temperature. Chosen with the thirteen recordings of tests/data/ur5_kufieta.
double between_recordings(TextbookTerm term) {
    return term == TextbookTerm::viscous || term == TextbookTerm::inertia ? 0.15 : 0.05;
}

/// Returns the finding of a term of a fit. `everywhere`: a fit of the whole arm, which has friction at every
/// joint, so that only its size is uncertain.
Finding finding_of(const DiagnosisWork& work, const Effect& effect, const MovingFit& fit, Index output,
                   bool everywhere) {
    // least log-evidence of a cause with one coefficient in the panel's search
    constexpr double one_coefficient_penalty = 8;
    const auto term = static_cast<Index>(*effect.textbook);
    const double value = fit.values[term];
    const double of_fit = std::max(std::sqrt(fit.covariance(term, term)), 1e-12);
    const double scatter = between_recordings(*effect.textbook) * value;
    const double deviation = everywhere ? std::hypot(of_fit, scatter) : of_fit;
    const double reach = everywhere ? deviations_of_95 * deviation
                                    : std::hypot(reach_of_95(of_fit, value), deviations_of_95 * scatter);
    const ParameterKind& kind = effect.parameters.front();
    Finding finding;
    finding.effect = effect.name;
    finding.where = place_text(PlaceKind::joint, static_cast<std::size_t>(output));
    const bool certain = everywhere && effect.friction;
    finding.parameters = {certain
                              ? positive_parameter(kind.name, kind.unit, value, deviation)
                              : FoundParameter{kind.name, kind.unit, value, value - reach, value + reach}};
    finding.margin_to_nothing = 0.5 * std::pow(value / deviation, 2) - one_coefficient_penalty;
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    const double duration_s = static_cast<double>(work.signals->rows()) / work.signals->measured.rate_hz;
    finding.confidence =
        certain ? probability_of_size(value, deviation) : calibrated_confidence(finding, duration_s);
    finding.confirm = confirmation(finding);
    return finding;
}

bool physically_possible(const Effect& effect, double value) {
    return effect.textbook == TextbookTerm::offset || value > 0;
}

/// Returns the findings of a fit at an output's joint.
std::vector<Finding> findings_at(const DiagnosisWork& work, const MovingFit& fit, Index output,
                                 bool everywhere, const ErrorReduction& reduction) {
    std::vector<Finding> findings;
    for (const Effect& effect : effect_catalogue()) {
        if (!effect.textbook ||
            !physically_possible(effect, fit.values[static_cast<Index>(*effect.textbook)])) {
            continue;
        }
        Finding finding = finding_of(work, effect, fit, output, everywhere);
        MatrixXd share = MatrixXd::Zero(work.signals->rows(), work.signals->outputs());
        const auto term = static_cast<Index>(*effect.textbook);
        share.col(output) = fit.values[term] * fit.columns.col(term);
        const bool supported = finding.margin_to_nothing > 0 || (everywhere && effect.friction);
        if (!supported) {
            continue;
        }
        reduction.describe(finding, share);
        if (reduces_error(finding)) {
            findings.push_back(std::move(finding));
        }
    }
    return findings;
}

/// Adds the findings of plain least squares at a joint. Removes findings of the same effects, and lowers the
/// confidence of the others there.
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

/// Fits plain least squares of each output. Sets `textbook` of the diagnosis and `extended`.
std::vector<MovingFit> fit_outputs(DiagnosisWork& work) {
    const DiagnosisSignals& signals = *work.signals;
    Diagnosis& diagnosis = work.diagnosis;
    diagnosis.textbook = MatrixXd::Zero(5, signals.outputs());
    work.extended = signals.nominal + work.fitted_effects.reported_contribution(signals);
    const MatrixXd all_rows =
        textbook_fit(signals, work.measured, signals.nominal, signals.rows()).prediction;
    std::vector<MovingFit> fits;
    for (Index output = 0; output < signals.outputs(); ++output) {
        fits.push_back(fit_moving_rows(signals, work.measured.col(output), signals.nominal.col(output),
                                       output, work.gains_known));
        diagnosis.textbook.col(output) = fits.back().values;
        if (diagnosis.by_least_squares[static_cast<std::size_t>(output)]) {
            work.extended.col(output) = all_rows.col(output);
        }
    }
    return fits;
}

/// Returns the residual of the fits of single outputs.
MatrixXd rest_of(const DiagnosisWork& work, const std::vector<MovingFit>& fits) {
    MatrixXd rest = work.measured;
    for (std::size_t output = 0; output < fits.size(); ++output) {
        rest.col(static_cast<Index>(output)) -= fits[output].columns * fits[output].values;
    }
    return rest;
}

/// Returns plain least squares of all joints. Where they are named, links may differ from the robot's file:
/// at a single joint, friction and offset would absorb such errors. `everywhere`: all joints are named.
/// Otherwise a joint's noise is also that of its own fit, which sees a longer correlation.
ArmFit fit_joints(DiagnosisWork& work, bool everywhere) {
    const DiagnosisSignals& signals = *work.signals;
    std::vector<MovingFit> single = fit_outputs(work);
    const bool any =
        std::ranges::find(work.diagnosis.by_least_squares, true) != work.diagnosis.by_least_squares.end();
    if (signals.wrench() || (!everywhere && !any)) {
        MatrixXd rest = rest_of(work, single);
        return {std::move(single), std::move(rest)};
    }
    ArmFit fit = fit_arm(signals, work.measured, single, work.gains_known);
    for (std::size_t joint = 0; !everywhere && joint < single.size(); ++joint) {
        auto variances = fit.joints[joint].covariance.diagonal();
        variances = variances.cwiseMax(single[joint].covariance.diagonal()).eval();
    }
    return fit;
}

} // namespace

bool friction_everywhere(const DiagnosisWork& work) {
    const DiagnosisSignals& signals = *work.signals;
    const std::vector<bool>& inexact = work.fitted_effects.inexact;
    std::size_t moving = 0;
    std::size_t real = 0;
    for (std::size_t joint = 0; !signals.wrench() && joint < signals.joints(); ++joint) {
        if (signals.hardly_moves(joint)) {
            continue;
        }
        ++moving;
        const bool no_effect_fits = joint < inexact.size() && inexact[joint];
        real += no_effect_fits || work.diagnosis.by_least_squares[joint] ? 1 : 0;
    }
    return real >= 2 && 2 * real >= moving;
}

double probability_of_size(double value, double deviation) {
    constexpr double share = 0.5;
    return std::erf(share * std::abs(value) / (deviation * std::numbers::sqrt2));
}

void name_by_least_squares(DiagnosisWork& work) {
    constexpr Index fewest_blocks = 10; // twice the coefficients
    const DiagnosisSignals& signals = *work.signals;
    const bool everywhere = friction_everywhere(work);
    ArmFit fit = fit_joints(work, everywhere);
    for (const StationaryContact& push : work.pushes) {
        fit.rest.col(static_cast<Index>(push.joint)) -= push.share;
    }
    const ErrorReduction reduction(signals, fit.rest, work.diagnosis.output_names);
    for (std::size_t output = 0; !signals.wrench() && output < fit.joints.size(); ++output) {
        const MovingFit& own = fit.joints[output];
        if ((everywhere || work.diagnosis.by_least_squares[output]) && !signals.hardly_moves(output) &&
            own.blocks >= fewest_blocks) {
            replace_findings(work.diagnosis.findings,
                             findings_at(work, own, static_cast<Index>(output), everywhere, reduction),
                             place_text(PlaceKind::joint, output), place_text(PlaceKind::actuator, output),
                             own.another_gain);
        }
    }
    sort_by_reduction(work.diagnosis.findings);
}

} // namespace dfdyn::tools
