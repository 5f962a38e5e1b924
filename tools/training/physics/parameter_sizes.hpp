// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A fitted parameter is rejected if it exceeds its size by this factor. Large values are possible: a column
/// may represent a combination of parameters, such as a mass plus a first moment divided by a short link's
/// length, and values of nearly equal columns may cancel. Two real recordings with tolerable predictions have
/// values of 13 times the size; columns of rounding errors had 1e13 times.
inline constexpr double parameter_margin = 100;

/// Returns the largest plausible magnitude of each physical parameter for the robot's size: P entries > 0,
/// ten per body of `chain`, then `effects`. The reach r (m) is the sum of the distances between joints and of
/// prismatic travels, up to the tip or the farthest centre of mass. With it, the mass m of the moving links
/// (kg), and per joint the torque T = max(effort limit, m g r) and the velocity limit v, the sizes are
/// - of a body: mass m; first moment m r; rotational inertia m r^2, because a column represents combinations
///   over all links;
/// - of an effect, by its ParameterSize: `effort` T; `effort_per_velocity` T / v; `inertia` m r^2; `weight`
///   m g (forces), m g r (torques).
///
/// Prismatic joints: forces, T = max(effort limit, m g), and `inertia` m. Effort limits above 100 m g r and
/// velocity limits above 100 rad/s (m/s) are placeholders and ignored; v is then 1. If the robot's file
/// contains no mass, m follows from the largest effort limit as T / (g r); without both it is 1000 kg. r is
/// at least 1 cm.
Eigen::VectorXd parameter_sizes(const Robot& robot, const ChainModel& chain,
                                const std::vector<EffectModel>& effects);

/// Returns the robot's own parameters, and zero for each of `effects`: P entries.
Eigen::VectorXd expected_parameters(const Robot& robot, const ChainModel& chain,
                                    const std::vector<EffectModel>& effects);

/// Returns the prior standard deviation of each parameter about expected_parameters(): P entries > 0.
/// - of a link: 0.3 times the sizes of a body with mass and reach of the links from its joint to the tip, or
///   once if the file contains none of their masses;
/// - of the last link, in addition: a tool with 0.05 times the robot's mass and, beyond the link, reach;
/// - of an effect: its size times EffectKind::expected_share.
Eigen::VectorXd parameter_deviations(const Robot& robot, const ChainModel& chain,
                                     const std::vector<EffectModel>& effects);

/// Throws InputError with name, value and bound of the first parameter of `physics`, in its initial state,
/// that exceeds parameter_margin times its size. `sizes` as from parameter_sizes().
void check_parameters(const PhysicsModel& physics, const Eigen::VectorXd& sizes);

} // namespace dfdyn::tools
