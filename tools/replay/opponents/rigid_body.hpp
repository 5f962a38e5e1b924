// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/zero_phase_derivatives.hpp"
#include "tools/replay/opponents/opponents.hpp"
#include "tools/robot/robot.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// Fits the textbook alternative to a learned model to all recordings by least squares: a rigid body with
/// viscous friction, dry friction and an offset per joint (for a wrench, a constant per axis). See for
/// instance W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots" (2002), chapter 12.
///
/// Returns two fits:
/// 1. With the robot file's inertia: a gain and three friction terms for each output separately. Any motion
///    determines these four coefficients.
/// 2. With identified inertia: all parameters that the recordings determine (`select_columns` with training's
///    threshold and sizes), together with the friction terms. Each output is weighted by its residual in an
///    unweighted fit. If the motion does not excite the parameters well, the first fit predicts other motions
///    better.
///
/// Velocities and accelerations are those of the recordings or zero-phase derivatives (`sampled_motion`) over
/// a window of `rigid_body_window_s` on both sides. The fit therefore uses 40 ms of future positions, which
/// no model has. If there are more than 20,000 rows, evenly spaced ones are used. `output_gain`: m outputs
/// per N·m of the joint. Returns nothing if no row has a complete window. Cost: rows · m · (10 bodies + 4)².
std::vector<RigidBodyFit> fit_rigid_body(const Robot& robot, const ChainModel& chain,
                                         const std::vector<double>& output_gain, double sign_velocity,
                                         std::span<const Recording> recordings);

/// Returns the fit's prediction for each row of a recording from its motion alone: rows × m; NaN for rows
/// without a complete window.
Forecasts rigid_body_forecasts(const RigidBodyFit& fit, const ChainModel& chain, const Recording& recording);

/// Returns the physics of the first model with fits; nullptr if there is none.
const PhysicsModel* rigid_body_of(std::span<const TrainedModel> models);

} // namespace dfdyn::tools
