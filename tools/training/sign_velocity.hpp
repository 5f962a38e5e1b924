// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/training_data.hpp"
#include "tools/training/physics/regressor.hpp"
#include "tools/training/training_options.hpp"

#include <functional>
#include <memory>

namespace dfdyn::tools {

/// v of dry friction's tanh(qd / v) unless it is given or chosen, rad/s (m/s).
constexpr double usual_sign_velocity = 0.05;

/// Returns the v, of six from 0.002 to 0.1 rad/s, with which physics and white noise are the most likely
/// cause of the outputs. `regressor_at` returns the physics for a v. `options` are those of the training,
/// with an input of positions and PhysicsMotion::free: other motions have a scale of their own. Throws
/// InputError as train() does. Cost: six trainings of P with at most 400 rows and one start each.
double most_likely_sign_velocity(
    const TrainingData& data, const TrainingOptions& options,
    const std::function<std::unique_ptr<Regressor>(double sign_velocity)>& regressor_at);

} // namespace dfdyn::tools
