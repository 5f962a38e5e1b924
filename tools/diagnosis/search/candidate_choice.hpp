// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/search/fitted_effects.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A chosen candidate, identified by its key while the candidates of a search are replaced.
struct KeptChoice {
    std::string key;
    std::size_t shape;
    std::optional<std::size_t> columns; ///< of the shape, if shapes are made for each model
};

/// Returns false for a candidate at a joint that hardly moves.
bool visible(const DiagnosisSignals& signals, const Candidate& candidate);

/// Returns whether the candidate is of an effect that yields to others (`Effect::yields`).
bool yields(const Candidate& candidate);

/// Returns whether such a candidate is chosen.
bool has_yielding(const FittedEffects& effects);

/// Share of a cause's evidence. A smaller difference to a similar cause is within the error of their columns.
inline constexpr double model_error_share = 0.02;

/// Returns whether the candidate is the dry friction that least squares knows.
bool is_coulomb(const Candidate& candidate);

/// Sets the number of candidates of each one's class, which is its prior: the unnamed ones, or the named ones
/// without those that yield. For these it is the number of all named ones. They do not change the prior of
/// the others.
void set_classes(FittedEffects& effects);

/// Returns a candidate, relinearized about its estimate. The number of its new shapes does not change its
/// prior.
Candidate relinearized(const Candidate& candidate, const EffectShape& shape,
                       const Eigen::VectorXd& coefficients);

/// Returns the candidates with `always_relinearized`, each about the estimate of its last shape in the chosen
/// model, in place of all of its family. Those whose estimates are inadmissible are left out.
std::vector<Candidate> relinearized_always(const FittedEffects& effects);

/// Returns the chosen candidates.
std::vector<KeptChoice> kept_choices(const FittedEffects& effects);

/// Chooses those candidates again that still exist.
void choose_again(FittedEffects& effects, const std::vector<KeptChoice>& kept);

/// Returns the keys of the chosen candidates, sorted.
std::vector<std::string> chosen_keys(const FittedEffects& effects);

} // namespace dfdyn::tools
