// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/physics/physics_start.hpp"
#include "tools/training/search/training_problem.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// What the physics leaves of a real arm's outputs (friction, gears, temperature) stays alike for about so
/// long (s): samples within it count as one. Chosen on two motions of a UR5 and on a servo (see
/// docs/reference/extrapolation.md).
inline constexpr double residual_correlation_s = 4;
/// The same where features explain most of it (SP, SPK). Chosen on one of these motions, after the other.
inline constexpr double residual_correlation_with_features_s = 0.5;

/// The number of the recording's samples that count as one for the model; at least 1.
double parameter_variance_factor(const TrainingSetup& setup);

/// What the robot itself says of the chosen parameters: N(PhysicsOptions::nominal, nominal_deviation^2) for
/// all parameters of the regressor, as the chosen columns can express them; times the
/// parameter_variance_factor() in its information, because as many samples count as one. `choice`: columns
/// and scales; `motion`: the physics' motion parameters. Deterministic. O(R m P^2), R likelihood rows and
/// 300 random states.
///
/// A column left out is a linear combination of those chosen, over the recording and, as far as that leaves
/// it open, over random states with positions within ± pi and velocities and accelerations as large as the
/// recording's. Its parameter adds that combination to the others.
ParameterPrior robot_prior(const TrainingSetup& setup, const ColumnChoice& choice,
                           const Eigen::VectorXd& motion);

} // namespace dfdyn::tools
