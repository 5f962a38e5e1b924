// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A fitted parameter is refused beyond this many times its size: a column chosen for a combination of
/// parameters carries, for instance, a first moment divided by a short link as a mass, and the values of
/// columns that are nearly the same may cancel each other. Two real recordings that predict tolerably have
/// such values at 13 times their size; columns of rounding error had 1e13 times.
inline constexpr double parameter_margin = 100;

/// The magnitude that each physical parameter can have in a machine of the robot's size: P entries > 0, ten
/// per body of `chain`, then `effects`. From the total mass m of the moving links (kg), the reach r (sum of
/// the distances between joints and of sliding travels, on to the tip or the farthest centre of mass, m), and
/// per joint the torque T =
/// max(effort limit, m g r) and the velocity limit v:
/// - mass: m; first moment: m r; rotational inertia and rotor inertia: m r^2, because a column stands for
///   combinations over all links, not for one link;
/// - Coulomb and Stribeck friction, ripple and offset: T; viscous friction: T / v; spring: T per rad;
/// - bias of a force/torque sensor: m g (forces), m g r (torques).
/// Prismatic joints: forces, T = max(effort limit, m g). Effort limits above 100 m g r and velocity limits
/// above 100 rad/s (m/s) are placeholders and not read; v is then 1. Without any mass in the robot's file, m
/// follows from the largest effort limit as T / (g r), and without both it is 1000 kg. r is at least 1 cm.
Eigen::VectorXd parameter_sizes(const Robot& robot, const ChainModel& chain,
                                const std::vector<EffectModel>& effects);

/// The robot's own parameters, and zero for each of `effects`: P entries.
Eigen::VectorXd expected_parameters(const Robot& robot, const ChainModel& chain,
                                    const std::vector<EffectModel>& effects);

/// How far each parameter may be from expected_parameters(): P entries > 0. As parameter_sizes(), but of a
/// body with only what hangs on its joint: mass and reach of the links from there to the tip.
Eigen::VectorXd parameter_deviations(const Robot& robot, const ChainModel& chain,
                                     const std::vector<EffectModel>& effects);

/// Throws InputError with name, value and bound of the first parameter of `physics`, at the start of
/// learning, that is beyond parameter_margin times its size. `sizes` as of parameter_sizes().
void check_parameters(const PhysicsModel& physics, const Eigen::VectorXd& sizes);

} // namespace dfdyn::tools
