// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/score/panel_score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dfdyn::tests {

namespace {

constexpr std::size_t largest_class = 3;

bool is(const tools::Finding& finding, const HiddenEffect& hidden) {
    return finding.effect == hidden.effect && finding.where == hidden.where;
}

/// Returns whether the finding is specific enough: its class of indistinguishable causes is small.
bool answers(const tools::Finding& finding) { return finding.indistinguishable.size() < largest_class; }

bool has(const tools::Finding& finding, const HiddenEffect& hidden) {
    return answers(finding) && std::any_of(finding.indistinguishable.begin(), finding.indistinguishable.end(),
                                           [&](const tools::OtherCause& cause) {
                                               return cause.effect == hidden.effect &&
                                                      cause.where == hidden.where;
                                           });
}

void score_parameter(EffectScore& score, const HiddenEffect& hidden, const tools::Finding& finding) {
    if (hidden.parameters.empty()) {
        return;
    }
    const auto& [name, value] = hidden.parameters.front();
    const auto found = std::ranges::find(finding.parameters, name, &tools::FoundParameter::name);
    if (found == finding.parameters.end()) {
        return;
    }
    // A gain of 1 means no error.
    const bool is_factor = hidden.effect == "actuator_gain" || hidden.effect == "ft_gain";
    score.relative_error = std::abs(found->value - value) / std::abs(is_factor ? value - 1 : value);
    score.in_interval = found->low <= value && value <= found->high;
}

std::string name_of(const tools::Finding& finding) { return finding.effect + "@" + finding.where; }

EffectScore score_effect(const HiddenEffect& hidden, const tools::Diagnosis& diagnosis) {
    EffectScore score{
        hidden.effect, hidden.where, hidden.strength, hidden.evidence, false, false, false, "nothing", {},
        false};
    for (const tools::Finding& finding : diagnosis.findings) {
        if (is(finding, hidden) && answers(finding)) {
            score.named = true;
            score.alone = finding.indistinguishable.empty();
            score.named_as = name_of(finding);
            score_parameter(score, hidden, finding);
            return score;
        }
    }
    for (const tools::Finding& finding : diagnosis.findings) {
        if (has(finding, hidden)) {
            score.in_class = true;
            score.named_as = name_of(finding);
            return score;
        }
    }
    if (!diagnosis.findings.empty()) {
        score.named_as = name_of(diagnosis.findings.front());
    }
    return score;
}

FindingScore score_finding(const PanelCase& panel_case, const tools::Finding& finding) {
    FindingScore score{finding.effect,           finding.where,
                       finding.confidence,       finding.margin_to_nothing,
                       finding.margin_to_others, finding.indistinguishable.size()};
    const auto any = [&](const std::vector<HiddenEffect>& effects, const auto& matches) {
        return std::ranges::any_of(effects,
                                   [&](const HiddenEffect& effect) { return matches(finding, effect); });
    };
    const bool wrong_link = panel_case.masses_off && finding.effect.starts_with("link_");
    score.ordinary = any(panel_case.ordinary, is);
    score.own_name = score.ordinary || wrong_link || any(panel_case.hidden, is);
    score.right = score.own_name || any(panel_case.hidden, has) || any(panel_case.ordinary, has);
    return score;
}

std::vector<ConstantScore> score_constants(const PanelCase& panel_case, const tools::Diagnosis& diagnosis) {
    std::vector<ConstantScore> result;
    for (const tools::NuisanceEstimate& nuisance : diagnosis.nuisance_estimates) {
        const tools::FoundParameter& found = nuisance.parameter;
        if (found.name == "torque_constant") {
            const double truth = panel_case.torque_constants[result.size()];
            result.push_back({std::abs(found.value / truth - 1), found.low <= truth && truth <= found.high});
        }
    }
    return result;
}

/// Relative change of the error on held-out time, from the mean of squares over the outputs.
double harm_of(const tools::Diagnosis& diagnosis) {
    const Eigen::ArrayXd ratio = diagnosis.extended.rms.array() / diagnosis.nominal.rms.array();
    return std::sqrt(ratio.square().mean()) - 1;
}

} // namespace

bool is_exact(const PanelCase& panel_case) {
    return panel_case.hidden.empty() && panel_case.ordinary.empty() && !panel_case.masses_off &&
           panel_case.torque_constants_known;
}

CaseScore score_case(const PanelCase& panel_case, const tools::Diagnosis& diagnosis) {
    CaseScore score;
    score.seed = panel_case.seed;
    score.robot = panel_case.robot_name;
    score.noise = panel_case.noise;
    score.masses_off = panel_case.masses_off;
    score.outside = panel_case.outside_catalogue;
    for (const HiddenEffect& hidden : panel_case.hidden) {
        score.effects.push_back(score_effect(hidden, diagnosis));
    }
    for (const tools::Finding& finding : diagnosis.findings) {
        score.findings.push_back(score_finding(panel_case, finding));
    }
    for (const tools::Suspicion& suspicion : diagnosis.suspicions) {
        if (!suspicion.code.empty()) {
            score.refusals.push_back(suspicion.code + " (" + suspicion.text + ")");
        }
    }
    score.constants = score_constants(panel_case, diagnosis);
    if (is_exact(panel_case)) {
        score.harm = harm_of(diagnosis);
    }
    if (score.outside && !panel_case.hidden.empty()) {
        const HiddenEffect& hidden = panel_case.hidden.front();
        score.unexplained_right =
            std::ranges::any_of(diagnosis.unexplained, [&](const tools::Unexplained& entry) {
                return diagnosis.output_names[static_cast<std::size_t>(entry.output)] == hidden.main_output &&
                       std::ranges::find(entry.depends_on, hidden.depends_on) != entry.depends_on.end();
            });
    }
    return score;
}

std::string describe(const CaseScore& score) {
    std::string text = std::to_string(score.seed) + " " + score.robot + " " + score.noise +
                       (score.masses_off ? " off" : " exact");
    std::array<char, 200> part{};
    for (const EffectScore& effect : score.effects) {
        std::snprintf(part.data(), part.size(), " | %s %s@%s x%.2g (%.3g)%s",
                      effect.found() ? (effect.named ? "OK" : "ok-class") : "MISS", effect.effect.c_str(),
                      effect.where.c_str(), effect.strength, effect.evidence,
                      score.outside ? " outside" : "");
        text += part.data();
        if (effect.relative_error) {
            std::snprintf(part.data(), part.size(), " err %.0f%%%s", 100 * *effect.relative_error,
                          effect.in_interval ? "" : " out");
            text += part.data();
        }
    }
    if (score.outside) {
        text += score.unexplained_right ? " told" : " not told";
    }
    if (score.harm) {
        std::snprintf(part.data(), part.size(), " harm %+.2f%%", 100 * *score.harm);
        text += part.data();
    }
    text += " ||";
    for (const std::string& refusal : score.refusals) {
        text += " refused: " + refusal;
    }
    for (const FindingScore& finding : score.findings) {
        std::snprintf(part.data(), part.size(), " %s%s@%s %.2f (%.1f/%.1f,%zu)",
                      finding.own_name ? ""
                      : finding.right  ? "~"
                                       : "!",
                      finding.effect.c_str(), finding.where.c_str(), finding.confidence,
                      finding.margin_to_nothing, finding.margin_to_others, finding.ties);
        text += part.data();
    }
    std::snprintf(part.data(), part.size(), "  [%.1fs]", score.seconds);
    return text + part.data();
}

} // namespace dfdyn::tests
