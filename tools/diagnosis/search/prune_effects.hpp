// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"

namespace dfdyn::tools {

/// Prunes the fitted effects at the end of their search. Decides whether masses are uncertain, and keeps the
/// chosen effects that are admissible and that predict held-out blocks of time. Chooses Coulomb friction
/// where a kind that excludes it is hardly better. `regression`: of the effects' problem. Also fits the named
/// effects alone. Cost: one search after each removal.
void prune(FittedEffects& at, const EffectRegression& regression);

/// Fits the chosen effects, and the named ones alone: `fit` and `named`, which `values` become.
void fit_named(FittedEffects& at);

} // namespace dfdyn::tools
