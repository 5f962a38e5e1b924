// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/findings.hpp"

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/contact_pulse.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/search/candidate_choice.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Log-odds of 20 to 1. Causes with a smaller margin are indistinguishable.
constexpr double min_distinct_margin = 3;
constexpr double friction_error = 0.06;      ///< of a friction's evidence: error of its shape at reversals
constexpr double centre_occam_factor = 6;    ///< Occam factor of the three coefficients of a centre of mass
constexpr std::size_t most_alternatives = 3; ///< of a finding
constexpr std::size_t most_ties = 2;         ///< of a likely finding

/// Returns whether one is an offset of a joint's encoder, and the other an error of its link whose centre of
/// mass the motion does not determine along an axis. On an arm that moves in a plane, the offset moves the
/// centre of mass within this plane.
bool same_in_plane(const Candidate& offset, const Candidate& link) {
    const std::optional<Place> encoder = numbered_place(offset.where);
    const std::optional<Place> body = numbered_place(link.where);
    return offset.effect == effects::encoder_offset().name && has_trait(link.effect, &Effect::mass_of_link) &&
           encoder && body && encoder->index == body->index &&
           std::ranges::any_of(link.shapes, [](const EffectShape& shape) { return shape.undetermined > 0; });
}

/// Returns the log-evidence below which another candidate is indistinguishable from the finding's own.
/// Payload and last link, friction and Coulomb friction, and an encoder's offset and a link in a plane,
/// differ by less than their columns' errors.
double least_margin(const Finding& finding, const Candidate& own, const Candidate& other) {
    const double evidence = finding.margin_to_nothing;
    const bool same_span = !other.span.empty() && other.span == own.span;
    if (same_span || same_in_plane(own, other) || same_in_plane(other, own)) {
        return std::max(min_distinct_margin + centre_occam_factor, model_error_share * evidence);
    }
    const bool same_friction =
        own.where == other.where && has_trait(own.effect, &Effect::friction) && is_coulomb(other);
    return same_friction ? std::max(min_distinct_margin, friction_error * evidence) : min_distinct_margin;
}

/// Determines the alternatives to a chosen effect, and their odds.
void weigh_alternatives(Finding& finding, const FittedEffects& fitted_effects, const Neighbours& near,
                        std::size_t index) {
    const double own = fitted_effects.fit.score;
    const Candidate& own_candidate = fitted_effects.candidates[fitted_effects.chosen[index].candidate];
    finding.margin_to_nothing = own - near.score_without(index);
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    for (const Replacement& other : near.exchanges(index)) {
        const Candidate& candidate = fitted_effects.candidates[other.with.candidate];
        const double margin = own - other.score;
        if (!candidate.named() || other.with.candidate == fitted_effects.chosen[index].candidate ||
            (candidate.effect == finding.effect && candidate.where == finding.where)) {
            continue;
        }
        OtherCause cause{candidate.effect, candidate.where, {}};
        if (margin < least_margin(finding, own_candidate, candidate)) {
            finding.indistinguishable.push_back(std::move(cause));
            continue;
        }
        finding.margin_to_others = std::min(finding.margin_to_others, margin);
        if (finding.alternatives.size() < most_alternatives && margin < finding.margin_to_nothing) {
            const double gap = finding.margin_to_nothing - margin;
            cause.why_not = "explains " + rounded_text(100 * std::max(0.0, gap) / finding.margin_to_nothing) +
                            " % of what this cause explains";
            finding.alternatives.push_back(std::move(cause));
        }
    }
}

/// Returns a chosen named effect as a finding, without its error reduction.
Finding of_cause(const FittedEffects& fitted_effects, const Neighbours& near, std::size_t index,
                 double duration_s) {
    const Candidate& candidate = fitted_effects.candidates[fitted_effects.chosen[index].candidate];
    Finding finding;
    finding.effect = candidate.effect;
    finding.where = candidate.where;
    finding.detail = candidate.detail;
    finding.parameters = found_parameters(fitted_effects, index);
    weigh_alternatives(finding, fitted_effects, near, index);
    // confidence is low if an effect is significant only together with an unnamed one that cancels most of
    // it, or if the way in which friction builds up explains as much
    finding.margin_to_nothing = std::min(
        {finding.margin_to_nothing, fitted_effects.evidence(index), fitted_effects.margin_with_lags[index]});
    finding.confidence = calibrated_confidence(finding, duration_s);
    finding.confirm = confirmation(finding);
    return finding;
}

Finding of_push(const StationaryContact& push) {
    // upper limit for real arms: on simulated arms all such findings are correct
    constexpr double max_confidence = 0.95;
    Finding finding;
    finding.effect = effects::external_contact().name;
    finding.where = place_text(PlaceKind::joint, push.joint);
    finding.detail = start_words(push.pulse);
    // Friction usually yields before the motor compensates: it balances between zero and its full range. The
    // pulse that is fitted has a flat top. The peak of a sinusoidal contact is up to 30 % higher (simulated).
    constexpr double rounder = 0.15;
    const double more = push.held / 2 + rounder * std::abs(push.change);
    const double peak = -(push.change + std::copysign(more, push.change));
    for (const EffectParameter& one :
         contact_parameters(push.pulse, "N·m", Eigen::VectorXd::Constant(1, peak))) {
        const double reach =
            one.name == "peak" ? more + deviations_of_95 * push.deviation() : push.pulse.rise_s / 2;
        finding.parameters.push_back({one.name, one.unit, one.value, one.value - reach, one.value + reach});
    }
    finding.confidence = max_confidence * push.probability();
    finding.margin_to_nothing = std::log(finding.confidence / (1 - finding.confidence));
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    finding.confirm = confirmation(finding);
    return finding;
}

std::string held_words(const StationaryContact& push, bool prismatic) {
    const auto interval = [&](double value, double deviation) {
        return rounded_text(value) + " ± " + rounded_text(deviations_of_95 * deviation) + " " +
               unit_at_joint("N·m", prismatic);
    };
    return place_text(PlaceKind::joint, push.joint) + " is stationary: its friction can change by " +
           interval(push.held, push.held_deviation) + ", noise by " + rounded_text(push.noise) +
           ", but its " + (prismatic ? "force" : "torque") + " changes by " +
           interval(std::abs(push.change), push.change_deviation) + "; ";
}

/// Returns the chosen named effects that reduce the error.
std::vector<Finding> of_causes(const DiagnosisSignals& signals, const FittedEffects& fitted_effects,
                               const ErrorReduction& reduction) {
    const double duration_s = static_cast<double>(signals.rows()) / signals.measured.rate_hz;
    const Neighbours near(fitted_effects.problem, fitted_effects.chosen);
    // named effects are the first of those chosen
    const std::vector<ChosenShape> named = fitted_effects.named_effects();
    std::vector<Finding> findings;
    for (std::size_t i = 0; i < named.size(); ++i) {
        const std::string key = fitted_effects.candidates[named[i].candidate].key();
        Finding finding = of_cause(fitted_effects, near, i, duration_s);
        reduction.describe(finding, fitted_effects.contribution_of(
                                        signals, [&](const Candidate& one) { return one.key() == key; }));
        if (reduces_error(finding)) {
            findings.push_back(std::move(finding));
        }
    }
    return findings;
}

std::vector<Finding> of_pushes(const DiagnosisSignals& signals, const std::vector<StationaryContact>& pushes,
                               const ErrorReduction& reduction) {
    std::vector<Finding> findings;
    for (const StationaryContact& push : pushes) {
        Finding finding = of_push(push);
        Eigen::MatrixXd contribution = Eigen::MatrixXd::Zero(signals.rows(), signals.outputs());
        contribution.col(static_cast<Eigen::Index>(push.joint)) = push.share;
        reduction.describe(finding, contribution);
        finding.evidence = held_words(push, signals.robot.joints[push.joint].prismatic) + finding.evidence;
        findings.push_back(std::move(finding));
    }
    return findings;
}

bool same_contact(const Finding& one, const Finding& other) {
    constexpr double apart_s = 0.5;
    const auto start_s = [](const Finding& finding) { return finding.parameters[0].value; };
    const auto end_s = [](const Finding& finding) { return finding.parameters[1].value; };
    return has_trait(one.effect, &Effect::interval) && other.effect == one.effect &&
           one.where == other.where && start_s(one) < end_s(other) + apart_s &&
           start_s(other) < end_s(one) + apart_s;
}

/// A contact appears on several axes and in several pulses. Keeps the one that reduces the error most.
std::vector<Finding> without_repeated_contacts(std::vector<Finding> findings) {
    sort_by_reduction(findings);
    std::vector<Finding> kept;
    for (Finding& finding : findings) {
        if (std::none_of(kept.begin(), kept.end(),
                         [&](const Finding& one) { return same_contact(one, finding); })) {
            kept.push_back(std::move(finding));
        }
    }
    return kept;
}

/// Adds a contact during standstill. It replaces the same contact from the search unless that one has a
/// higher confidence.
void add_push(std::vector<Finding>& findings, Finding push) {
    const auto same =
        std::ranges::find_if(findings, [&](const Finding& finding) { return same_contact(finding, push); });
    if (same == findings.end()) {
        findings.push_back(std::move(push));
    } else if (same->confidence < push.confidence) {
        *same = std::move(push);
    }
}

/// Returns whether the only size of a finding has an interval that contains the value without the effect.
bool may_be_none(const Finding& finding) {
    const Effect& effect = effect_named(finding.effect);
    const bool one_size = effect.textbook || effect.parameters.size() == 1;
    if (!one_size || finding.parameters.empty()) {
        return false;
    }
    const std::optional<double> none = effect.parameters.front().null_value;
    const FoundParameter& size = finding.parameters.front();
    return none && size.low < size.high && size.low <= *none && *none <= size.high;
}

} // namespace

std::string confirmation(const Finding& finding) {
    return finding.where + ": " + effect_named(finding.effect).experiment;
}

void sort_by_reduction(std::vector<Finding>& findings) {
    std::ranges::sort(findings, std::greater<>{},
                      [](const Finding& finding) { return finding.rms_before / finding.rms_after; });
}

double calibrated_confidence(const Finding& finding, double duration_s) {
    // Logistic regression on correct and wrong findings in simulated recordings of 50 s and of 200 s:
    // docs/results/diagnosis-panel.md. The margin to the next cause did not improve it. The evidence of model
    // errors increases with the recording's length as for a real cause; the time term compensates this.
    const double to_nothing = std::log(std::max(finding.margin_to_nothing, 0.1));
    const double time = std::log(std::clamp(duration_s, 50.0, 200.0) / 50);
    const Effect* const effect = find_effect(finding.effect);
    const double burst = effect == nullptr ? 0 : effect->burst_evidence;
    return 1 / (1 + std::exp(2 + burst + 0.8 * time - 0.74 * to_nothing));
}

void doubt_useless_findings(Diagnosis& diagnosis) {
    constexpr double min_ratio = 1.01; // of the errors without and with the effect
    for (Finding& finding : diagnosis.findings) {
        const bool unexplained = diagnosis.extended.nrmse[finding.output] > 1;
        const bool no_reduction = !has_trait(finding.effect, &Effect::interval) &&
                                  finding.rms_before < min_ratio * finding.rms_after;
        const bool one_of_many = finding.indistinguishable.size() > most_ties;
        if (unexplained || no_reduction || one_of_many || may_be_none(finding)) {
            finding.confidence = std::min(finding.confidence, unlikely);
        }
    }
}

std::vector<Finding> findings_of(const DiagnosisSignals& signals, const FittedEffects& fitted_effects,
                                 const std::vector<StationaryContact>& pushes, const Eigen::MatrixXd& rest,
                                 const std::vector<std::string>& output_names) {
    const ErrorReduction reduction(signals, rest, output_names);
    std::vector<Finding> findings = without_repeated_contacts(of_causes(signals, fitted_effects, reduction));
    for (Finding& push : of_pushes(signals, pushes, reduction)) {
        add_push(findings, std::move(push));
    }
    sort_by_reduction(findings);
    return findings;
}

} // namespace dfdyn::tools
