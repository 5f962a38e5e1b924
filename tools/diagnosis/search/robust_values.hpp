// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/search/fitted_effects.hpp"

namespace dfdyn::tools {

/// Sets `values` of pruned effects, and removes effects that only the noise's weights support.
///
/// The noise's spectrum gives the best weights where the effects are exactly right. Otherwise the frequencies
/// with the least noise dominate, which have little of the torque: dry friction, for example, is then fitted
/// to its reversals. A second fit gives all frequencies the same weight. An output at which the two differ by
/// more than noise can explain (a specification test: J. A. Hausman, 1978) has these weights in `values`.
/// There an effect is removed if its evidence is below its prior penalty. The covariance is for noise with
/// its own spectrum. Changes the weights of `regression`.
void make_robust(FittedEffects& at, EffectRegression& regression);

} // namespace dfdyn::tools
