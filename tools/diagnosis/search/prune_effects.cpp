// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/prune_effects.hpp"

#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/search/candidate_choice.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr Eigen::Index validation_blocks = 6;
constexpr double wrong_link_log_odds = 5; ///< prior log-odds (150 to 1) against an error of one link

/// Returns whether the model with exact masses needs additional named effects, all of them errors of links.
bool needs_links_only(const FittedEffects& at, const std::vector<ChosenShape>& exact) {
    bool links = false;
    for (const ChosenShape& one : exact) {
        const bool is_new =
            std::ranges::find(at.chosen, one.candidate, &ChosenShape::candidate) == at.chosen.end();
        if (is_new && !has_trait(at.candidates[one.candidate].effect, &Effect::mass_of_link)) {
            return false;
        }
        links = links || is_new;
    }
    return links;
}

/// Decides whether the links' masses equal those of the robot's file. The search before assumed uncertain
/// masses. One wrong link and uncertain masses of all links have equal prior probabilities, so that the
/// penalty of the first link is compensated; each further link has the full penalty.
void decide_masses(FittedEffects& at, const EffectRegression& regression) {
    at.problem.sums = regression.weighted_sums();
    at.chosen = search_effects(at.problem, at.chosen);
    at.fit = fit_effects(at.problem, at.chosen);
    SearchProblem exact = at.problem;
    exact.nuisance.erase(exact.nuisance.begin(), exact.nuisance.begin() + at.uncertain_masses);
    const std::vector<ChosenShape> chosen = search_effects(exact, at.chosen);
    const EffectFit fit = fit_effects(exact, chosen);
    if (fit.score + (needs_links_only(at, chosen) ? wrong_link_log_odds : 0) >= at.fit.score) {
        at.problem = std::move(exact);
        at.chosen = chosen;
        at.fit = fit;
        at.nuisance.erase(at.nuisance.begin(), at.nuisance.begin() + at.uncertain_masses);
        at.uncertain_masses = 0;
    }
}

std::vector<WeightedSums> sums_of_blocks(const EffectRegression& regression) {
    std::vector<WeightedSums> blocks;
    const Eigen::Index frames = regression.fitted_frames();
    for (Eigen::Index block = 0; block < validation_blocks; ++block) {
        const Eigen::Index first = block * frames / validation_blocks;
        blocks.push_back(regression.weighted_sums(first, (block + 1) * frames / validation_blocks - first));
    }
    return blocks;
}

/// Returns the coefficients of all columns: those of the chosen events, and zeros elsewhere. Other times
/// carry no information on an event.
Eigen::VectorXd of_events(const FittedEffects& at, Eigen::Index columns) {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(columns);
    const Eigen::VectorXd all = at.fit.of_all(columns);
    for (const ChosenShape& one : at.chosen) {
        if (at.candidates[one.candidate].event) {
            const auto& own = at.problem.candidates[one.candidate].shapes[one.shape].columns;
            result(own) = all(own);
        }
    }
    return result;
}

/// Leave-one-block-out pruning: removes each persistent effect whose removal does not worsen the held-out
/// prediction, also from the `promising` candidates. The events' contribution is subtracted from all blocks.
/// Returns true if any effect was removed.
bool prune_unpredictive(FittedEffects& at, const EffectRegression& regression, SearchProblem& promising) {
    if (regression.fitted_frames() < validation_blocks) {
        return false; // too few frames for cross-validation
    }
    SearchProblem problem = at.problem;
    std::vector<WeightedSums> blocks = sums_of_blocks(regression);
    const Eigen::VectorXd events = of_events(at, regression.columns());
    problem.sums.moment -= problem.sums.gram * events;
    for (WeightedSums& block : blocks) {
        block.moment -= block.gram * events;
    }
    const auto persistent =
        std::stable_partition(at.chosen.begin(), at.chosen.end(),
                              [&at](const ChosenShape& one) { return at.candidates[one.candidate].event; });
    std::vector<ChosenShape> kept(persistent, at.chosen.end());
    at.chosen.erase(persistent, at.chosen.end());
    double best = held_out_score(problem, blocks, kept);
    bool dropped = false;
    while (true) {
        std::size_t worst = kept.size();
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const double others = held_out_score(problem, blocks, without(kept, i));
            if (others >= best) {
                best = others;
                worst = i;
            }
        }
        if (worst == kept.size()) {
            break;
        }
        promising.candidates[kept[worst].candidate].shapes.clear();
        dropped = true;
        kept = without(kept, worst);
    }
    at.chosen.insert(at.chosen.end(), kept.begin(), kept.end());
    return dropped;
}

/// Removes, one by one, named effects whose coefficients are inadmissible in the fit without unnamed effects.
/// A removed effect is no longer a candidate of `promising` or of the model's problem. Returns true if any
/// effect was removed.
bool prune_inadmissible(FittedEffects& at, SearchProblem& promising) {
    bool dropped = false;
    for (fit_named(at); !at.named.allowed; fit_named(at)) {
        const auto forbidden =
            std::ranges::find_if(at.chosen, [&, i = std::size_t{0}](const auto& one) mutable {
                return !at.problem.candidates[one.candidate].shapes[one.shape].allowed(at.coefficients(i++));
            });
        promising.candidates[forbidden->candidate].shapes.clear();
        at.problem.candidates[forbidden->candidate].shapes.clear();
        at.chosen.erase(forbidden);
        dropped = true;
    }
    return dropped;
}

/// Returns whether a candidate is friction that is neither known to least squares nor contains Coulomb
/// friction.
bool excludes_coulomb(const Candidate& candidate) {
    const Effect* const effect = find_effect(candidate.effect);
    return effect != nullptr && effect->friction && !effect->textbook &&
           std::ranges::find(effect->parameters, std::string("coulomb"), &ParameterKind::name) ==
               effect->parameters.end();
}

/// Returns the model with Coulomb friction in place of the chosen friction `index`, if that is hardly better:
/// the columns of all kinds of friction are inexact at reversals.
std::optional<std::vector<ChosenShape>> with_coulomb(const FittedEffects& at, std::size_t index) {
    const Neighbours near(at.problem, at.chosen);
    const Candidate& own = at.candidates[at.chosen[index].candidate];
    const double evidence = at.fit.score - near.score_without(index);
    for (const Replacement& other : near.exchanges(index)) {
        const Candidate& candidate = at.candidates[other.with.candidate];
        if (candidate.where == own.where && is_coulomb(candidate) &&
            at.fit.score - other.score < model_error_share * evidence) {
            std::vector<ChosenShape> simpler = at.chosen;
            simpler[index] = other.with;
            return simpler;
        }
    }
    return std::nullopt;
}

/// Replaces friction that depends on load or on the way by Coulomb friction where it is hardly better.
void prefer_coulomb(FittedEffects& at) {
    for (std::size_t index = 0; index < at.named_effects().size(); ++index) {
        if (!excludes_coulomb(at.candidates[at.chosen[index].candidate])) {
            continue;
        }
        if (const auto simpler = with_coulomb(at, index)) {
            const std::vector<ChosenShape> before = std::exchange(at.chosen, *simpler);
            fit_named(at);
            if (!at.named.allowed) {
                at.chosen = before;
                fit_named(at);
            }
        }
    }
}

} // namespace

void fit_named(FittedEffects& at) {
    std::stable_partition(at.chosen.begin(), at.chosen.end(),
                          [&at](const ChosenShape& one) { return at.candidates[one.candidate].named(); });
    at.fit = fit_effects(at.problem, at.chosen);
    at.named = fit_effects(at.problem, at.named_effects());
    at.values = at.named;
}

void prune(FittedEffects& at, const EffectRegression& regression) {
    decide_masses(at, regression);
    SearchProblem promising = at.problem; // without the shapes of removed effects
    while (prune_unpredictive(at, regression, promising) || prune_inadmissible(at, promising)) {
        at.chosen = search_effects(promising, at.chosen);
        at.fit = fit_effects(at.problem, at.chosen);
    }
    prefer_coulomb(at);
}

} // namespace dfdyn::tools
