// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/findings.hpp"

#include "tools/common/number.hpp"
#include "tools/common/root_mean_square.hpp"
#include "tools/diagnosis/effect_words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double two_sided = 1.96; ///< deviations that 95 % are within
constexpr double tie = 3; ///< odds of 20 to 1: closer than this the data cannot tell two causes apart
constexpr double price_of_shapes = 6; ///< what the three coefficients of a centre of mass cost
constexpr double same_body_share =
    0.02; ///< of the evidence: closer, payload and last link differ by less than models are wrong
constexpr std::size_t listed = 3; ///< alternatives that a finding tells of

/// A shape's parameters and their variances, by the gradient of each with respect to the coefficients.
struct ShapeParameters {
    std::vector<EffectParameter> values;
    Eigen::VectorXd variance;

    ShapeParameters(const Candidate& candidate, const EffectShape& shape, const Eigen::VectorXd& coefficients,
                    const Eigen::MatrixXd& covariance)
        : values(candidate.parameters(coefficients, shape)) {
        Eigen::MatrixXd gradient(static_cast<Eigen::Index>(values.size()), coefficients.size());
        for (Eigen::Index i = 0; i < coefficients.size(); ++i) {
            const double step = 1e-3 * std::sqrt(covariance(i, i)) + 1e-12;
            Eigen::VectorXd changed = coefficients;
            changed[i] += step;
            const std::vector<EffectParameter> moved = candidate.parameters(changed, shape);
            for (std::size_t k = 0; k < values.size(); ++k) {
                gradient(static_cast<Eigen::Index>(k), i) = (moved[k].value - values[k].value) / step;
            }
        }
        variance = (gradient * covariance * gradient.transpose()).diagonal().cwiseMax(0);
    }

    bool same_names(const ShapeParameters& other) const {
        return std::ranges::equal(values, other.values, {}, &EffectParameter::name, &EffectParameter::name);
    }
};

/// Of a chosen effect's parameters: their variance while the shape is the chosen one, and what it grows by
/// because other shapes are nearly as likely.
ShapeParameters parameters_over_shapes(const Explanation& explanation, std::size_t index) {
    const std::size_t number = explanation.chosen[index].candidate;
    const Candidate& candidate = explanation.candidates[number];
    std::vector<ChosenShape> named = explanation.named_effects();
    const EffectShape& own_shape = candidate.shapes[named[index].shape];
    const ShapeParameters own(candidate, own_shape, explanation.coefficients(index),
                              explanation.covariance(index));
    ShapeParameters result = own;
    double total = 1;
    for (std::size_t shape = 0; shape < candidate.shapes.size(); ++shape) {
        named[index].shape = shape;
        const EffectShape& other_shape = candidate.shapes[shape];
        if (shape == explanation.chosen[index].shape ||
            other_shape.columns.size() != own_shape.columns.size()) {
            continue;
        }
        const EffectFit fit = fit_effects(explanation.problem, named);
        const auto first = explanation.first_column(index);
        const auto count = std::ssize(other_shape.columns);
        const ShapeParameters other(candidate, other_shape, fit.coefficients.segment(first, count),
                                    fit.covariance.block(first, first, count, count));
        const double odds = std::exp(std::min(0.0, fit.score - explanation.named.score));
        if (fit.allowed && own.same_names(other)) {
            total += odds;
            for (Eigen::Index k = 0; k < own.variance.size(); ++k) {
                const auto i = static_cast<std::size_t>(k);
                const double apart = other.values[i].value - own.values[i].value;
                result.variance[k] += odds * (other.variance[k] + apart * apart);
            }
        }
    }
    result.variance /= total;
    return result;
}

std::vector<FoundParameter> found_parameters(const Explanation& explanation, std::size_t index) {
    const ShapeParameters all = parameters_over_shapes(explanation, index);
    std::vector<FoundParameter> result;
    for (std::size_t k = 0; k < all.values.size(); ++k) {
        const auto& [name, unit, value, of_nothing, unsettled] = all.values[k];
        const double of_data =
            reach_of_95(std::sqrt(all.variance[static_cast<Eigen::Index>(k)]), value - of_nothing);
        const double reach = std::hypot(of_data, two_sided * unsettled * value);
        result.push_back({name, unit, value, value - reach, value + reach});
    }
    return result;
}

/// What else could stand in the place of a chosen effect, and how much less likely that is.
void weigh_alternatives(Finding& finding, const Explanation& explanation, const Neighbours& near,
                        std::size_t index) {
    const double own = explanation.fit.score;
    const Candidate& own_candidate = explanation.candidates[explanation.chosen[index].candidate];
    finding.margin_to_nothing = own - near.score_without(index);
    finding.margin_to_others = std::numeric_limits<double>::infinity();
    for (const Replacement& other : near.exchanges(index)) {
        const Candidate& candidate = explanation.candidates[other.with.candidate];
        const double margin = own - other.score;
        if (!candidate.named() || other.with.candidate == explanation.chosen[index].candidate ||
            (candidate.effect == finding.effect && candidate.where == finding.where)) {
            continue;
        }
        OtherCause cause{candidate.effect, candidate.where, {}};
        const bool same_span = !candidate.span.empty() && candidate.span == own_candidate.span;
        const double same_body = std::max(tie + price_of_shapes, same_body_share * finding.margin_to_nothing);
        if (margin < (same_span ? same_body : tie)) {
            finding.indistinguishable.push_back(std::move(cause));
            continue;
        }
        finding.margin_to_others = std::min(finding.margin_to_others, margin);
        if (finding.alternatives.size() < listed && margin < finding.margin_to_nothing) {
            const double gap = finding.margin_to_nothing - margin;
            cause.why_not = "explains " + rounded_text(100 * std::max(0.0, gap) / finding.margin_to_nothing) +
                            " % of what this cause does";
            finding.alternatives.push_back(std::move(cause));
        }
    }
}

/// Each column low-passed: above it arms hardly move, and what no cause explains may hide that one explains
/// what is below.
Eigen::MatrixXd slow(const DiagnosisSignals& signals, const Eigen::MatrixXd& series) {
    Eigen::MatrixXd result(series.rows(), series.cols());
    for (Eigen::Index output = 0; output < series.cols(); ++output) {
        result.col(output) = signals.below(gains_below_hz, series.col(output));
    }
    return result;
}

/// The output on which the effect is largest against the noise there, and the errors with and without it.
void measure_gain(Finding& finding, const Eigen::MatrixXd& contribution, const Eigen::MatrixXd& left) {
    double largest = -1;
    for (Eigen::Index output = 0; output < left.cols(); ++output) {
        const double ratio = root_mean_square(contribution.col(output)) / root_mean_square(left.col(output));
        if (ratio > largest) {
            largest = ratio;
            finding.output = output;
        }
    }
    finding.rms_after = root_mean_square(left.col(finding.output));
    finding.rms_before = root_mean_square(left.col(finding.output) + contribution.col(finding.output));
}

/// What no cause explains, T x m.
struct Rest {
    Eigen::MatrixXd all, slow;
};

/// What the finding's contribution brings among slow errors, or where it shows above only, among all. Whether
/// it brings anything.
bool tell_gain(Finding& finding, const DiagnosisSignals& signals, const Eigen::MatrixXd& contribution,
               const Rest& left, const std::vector<std::string>& output_names) {
    measure_gain(finding, slow(signals, contribution), left.slow);
    std::string band = " below " + rounded_text(gains_below_hz) + " Hz";
    if (!(finding.rms_after < finding.rms_before)) {
        measure_gain(finding, contribution, left.all);
        band.clear();
    }
    finding.evidence = "the error of " + output_names[static_cast<std::size_t>(finding.output)] + " " +
                       effect_signature(finding.effect) + ": with it the error" + band + " falls from " +
                       rounded_text(finding.rms_before) + " to " + rounded_text(finding.rms_after);
    return finding.rms_after < finding.rms_before;
}

bool same_contact(const Finding& one, const Finding& other) {
    constexpr double apart_s = 0.5;
    const auto start_s = [](const Finding& finding) { return finding.parameters[0].value; };
    const auto end_s = [](const Finding& finding) { return finding.parameters[1].value; };
    return one.effect == "external_contact" && other.effect == one.effect && one.where == other.where &&
           start_s(one) < end_s(other) + apart_s && start_s(other) < end_s(one) + apart_s;
}

/// A contact shows on several axes, and by more than one pulse: the strongest of them tells of it.
std::vector<Finding> without_repeated_contacts(std::vector<Finding> findings) {
    std::vector<Finding> kept;
    for (Finding& finding : findings) {
        if (std::none_of(kept.begin(), kept.end(),
                         [&](const Finding& one) { return same_contact(one, finding); })) {
            kept.push_back(std::move(finding));
        }
    }
    return kept;
}

} // namespace

double reach_of_95(double deviation, double effect) {
    constexpr double coloured =
        1.7; // how much wider than their formula says: measured, docs/diagnosis-panel.md
    constexpr double model_error = 0.04; // what no noise explains, where effects are large; measured, too
    return two_sided * std::hypot(coloured * deviation, model_error * effect);
}

double calibrated_confidence(const Finding& finding, double duration_s) {
    // Logistic regression on what was right and wrong in simulated recordings of 50 and of 200 s:
    // docs/diagnosis-panel.md. How far the next cause is behind did not tell more. What the model has wrong
    // grows with the time as a true cause does.
    const double to_nothing = std::log(std::max(finding.margin_to_nothing, 0.1));
    const double time = std::log(std::clamp(duration_s, 50.0, 200.0) / 50);
    const double burst = finding.effect == "external_contact" ? 3 : 0; // real noise has bursts like pushes
    return 1 / (1 + std::exp(2 + burst + 0.8 * time - 0.74 * to_nothing));
}

std::vector<Finding> findings_of(const DiagnosisSignals& signals, const Explanation& explanation,
                                 const Eigen::MatrixXd& measured,
                                 const std::vector<std::string>& output_names) {
    Rest left{measured - signals.nominal - explanation.all(signals), {}};
    left.slow = slow(signals, left.all);
    const double duration_s = static_cast<double>(signals.rows()) / signals.measured.rate_hz;
    const Neighbours near(explanation.problem, explanation.chosen);
    const std::vector<ChosenShape> named = explanation.named_effects(); // the first of those chosen
    const Neighbours near_named(explanation.problem, named);
    std::vector<Finding> findings;
    for (std::size_t i = 0; i < named.size(); ++i) {
        const Candidate& candidate = explanation.candidates[named[i].candidate];
        Finding finding;
        finding.effect = candidate.effect;
        finding.where = candidate.where;
        finding.detail = candidate.detail;
        finding.parameters = found_parameters(explanation, i);
        weigh_alternatives(finding, explanation, near, i);
        // what stands only against something unnamed that takes most of it away again is hardly there
        finding.margin_to_nothing =
            std::min(finding.margin_to_nothing, explanation.named.score - near_named.score_without(i));
        finding.confidence = calibrated_confidence(finding, duration_s);
        finding.confirm = confirming_experiment(finding.effect, finding.where);
        const Eigen::MatrixXd contribution =
            explanation.effects(signals, [&](const Candidate& one) { return one.key() == candidate.key(); });
        if (tell_gain(finding, signals, contribution, left, output_names)) {
            findings.push_back(std::move(finding));
        }
    }
    std::ranges::sort(findings, std::greater<>{},
                      [](const Finding& finding) { return finding.rms_before / finding.rms_after; });
    return without_repeated_contacts(std::move(findings));
}

} // namespace dfdyn::tools
