// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/candidate_choice.hpp"

#include <algorithm>
#include <functional>

namespace dfdyn::tools {

namespace {

/// Returns the joint (from 0) at which a named candidate acts on measured torques; empty for other places.
std::optional<std::size_t> own_joint(const DiagnosisSignals& signals, const Candidate& candidate) {
    const std::optional<Place> place = numbered_place(candidate.where);
    if (signals.wrench() || !candidate.named() || !place ||
        (place->kind != PlaceKind::joint && place->kind != PlaceKind::actuator)) {
        return std::nullopt;
    }
    return place->index;
}

} // namespace

bool visible(const DiagnosisSignals& signals, const Candidate& candidate) {
    const std::optional<std::size_t> joint = own_joint(signals, candidate);
    return !joint || !signals.hardly_moves(*joint);
}

bool yields(const Candidate& candidate) { return has_trait(candidate.effect, &Effect::yields); }

bool is_coulomb(const Candidate& candidate) {
    const Effect* const effect = find_effect(candidate.effect);
    return effect != nullptr && effect->textbook == TextbookTerm::dry;
}

bool has_yielding(const FittedEffects& effects) {
    return std::ranges::any_of(
        effects.chosen, [&](const ChosenShape& one) { return yields(effects.candidates[one.candidate]); });
}

void set_classes(FittedEffects& effects) {
    const auto unnamed = std::ranges::count_if(effects.candidates, std::not_fn(&Candidate::named));
    const auto yielding = std::ranges::count_if(effects.candidates, yields);
    const auto named = std::ssize(effects.candidates) - unnamed;
    for (std::size_t i = 0; i < effects.candidates.size(); ++i) {
        const Candidate& one = effects.candidates[i];
        effects.problem.candidates[i].candidates_of_class =
            static_cast<double>(!one.named()  ? unnamed
                                : yields(one) ? named
                                              : named - yielding);
    }
}

Candidate relinearized(const Candidate& candidate, const EffectShape& shape,
                       const Eigen::VectorXd& coefficients) {
    Candidate result = candidate.relinearized_at(shape, coefficients);
    result.effect = candidate.effect;
    result.family = candidate.family;
    result.evidence_offset = candidate.evidence_offset;
    result.prior_trials = candidate.prior_trials * static_cast<double>(candidate.shapes.size()) /
                          static_cast<double>(result.shapes.size());
    return result;
}

std::vector<Candidate> relinearized_always(const FittedEffects& effects) {
    std::vector<Candidate> result;
    for (std::size_t i = 0; i < effects.candidates.size(); ++i) {
        const Candidate& candidate = effects.candidates[i];
        if (!candidate.always_relinearized) {
            continue;
        }
        const std::size_t whole = candidate.shapes.size() - 1;
        std::vector<ChosenShape> with = effects.chosen;
        std::erase_if(with, [&](const ChosenShape& one) {
            return effects.candidates[one.candidate].family == candidate.family;
        });
        with.push_back({i, whole});
        const EffectShape& shape = candidate.shapes[whole];
        const Eigen::VectorXd coefficients =
            fit_effects(effects.problem, with).coefficients.tail(std::ssize(shape.columns));
        if (shape.allowed(coefficients)) {
            result.push_back(relinearized(candidate, shape, coefficients));
        }
    }
    return result;
}

std::vector<KeptChoice> kept_choices(const FittedEffects& effects) {
    std::vector<KeptChoice> kept;
    for (const ChosenShape& one : effects.chosen) {
        const Candidate& candidate = effects.candidates[one.candidate];
        kept.push_back({candidate.key(), one.shape, {}});
        if (candidate.relinearized_at) {
            kept.back().columns = candidate.shapes[one.shape].columns.size();
        }
    }
    return kept;
}

void choose_again(FittedEffects& effects, const std::vector<KeptChoice>& kept) {
    effects.chosen.clear();
    for (const KeptChoice& one : kept) {
        const auto found = std::ranges::find(effects.candidates, one.key, &Candidate::key);
        if (found == effects.candidates.end()) {
            continue;
        }
        const auto as_many = [&](const EffectShape& shape) { return shape.columns.size() == one.columns; };
        const auto same = std::ranges::find_if(found->shapes, as_many);
        if (one.columns && same == found->shapes.end()) {
            continue; // the motion does not determine it about this estimate
        }
        effects.chosen.push_back(
            {static_cast<std::size_t>(found - effects.candidates.begin()),
             one.columns ? static_cast<std::size_t>(same - found->shapes.begin()) : one.shape});
    }
}

std::vector<std::string> chosen_keys(const FittedEffects& effects) {
    std::vector<std::string> keys;
    for (const ChosenShape& one : effects.chosen) {
        keys.push_back(effects.candidates[one.candidate].key());
    }
    std::ranges::sort(keys);
    return keys;
}

} // namespace dfdyn::tools
