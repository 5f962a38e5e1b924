// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/search/training_setup.hpp"
#include "tools/training/start/initial_state.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Correlation time (s) of the physics' residual on a real arm (friction, gears, temperature): samples within
/// it count as one. Chosen on two motions of a UR5 and on a servo (see docs/reference/extrapolation.md).
inline constexpr double residual_correlation_s = 4;
/// The correlation time if features explain most of the residual (SP, SPK). Chosen on one of these motions,
/// after the other.
inline constexpr double residual_correlation_with_features_s = 0.5;

/// Returns the number of the recording's samples that count as one for the model; at least 1.
double parameter_variance_factor(const TrainingSetup& setup);

/// Returns the robot's own prior of the chosen parameters: N(PhysicsOptions::nominal, nominal_deviation^2)
/// for all parameters of the regressor, as far as the chosen columns can express them. Its information is
/// multiplied by parameter_variance_factor(), because this number of samples counts as one. `choice`: columns
/// and scales; `motion`: the physics' motion parameters. Deterministic. O(R m P^2), R likelihood rows and 300
/// random states.
///
/// A column that was left out is a linear combination of the chosen ones over the recording. If the recording
/// does not determine the combination, random states do (positions within ± pi, velocities and accelerations
/// of the recording's size). Its parameter adds this combination to the others.
ParameterPrior robot_prior(const TrainingSetup& setup, const ColumnChoice& choice,
                           const Eigen::VectorXd& motion);

} // namespace dfdyn::tools
