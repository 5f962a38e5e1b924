// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/zero_phase_derivatives.hpp"
#include "tools/replay/opponents/opponents.hpp"
#include "tools/robot/robot.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// The textbook alternative to a learned model: a rigid body with viscous friction, dry friction and an
/// offset per joint (a wrench: a constant per axis), fitted to all recordings at once by least squares; see
/// for instance W. Khalil and E. Dombre, "Modeling, Identification and Control of Robots" (2002), chapter 12.
///
/// Returns two fits:
/// 1. The robot file's inertia. A gain and three friction terms of each output, output by output: four
///    coefficients, which any motion determines.
/// 2. Identified inertia. All parameters that the recordings determine (`select_columns` with training's
///    threshold and a machine's sizes), together with the friction terms; outputs weighed by what an
///    unweighted fit leaves of each. A poor motion determines them poorly: then the first predicts another
///    motion better.
///
/// Velocities and accelerations are the recordings' own or zero-phase derivatives (`sampled_motion`) over a
/// window of `rigid_body_window_s` on both sides, so an opponent has 40 ms of future positions that no model
/// has. Of more than 20,000 rows, evenly spaced ones count. `output_gain`: m outputs per N·m of the joint.
/// Returns nothing if no row has a full window. Cost: rows · m · (10 bodies + 4)².
std::vector<RigidBodyFit> fit_rigid_body(const Robot& robot, const ChainModel& chain,
                                         const std::vector<double>& output_gain, double sign_velocity,
                                         std::span<const Recording> recordings);

/// What the fit predicts for each row of a recording from its motion alone: rows × m; NaN where a row has no
/// full window.
Forecasts rigid_body_forecasts(const RigidBodyFit& fit, const ChainModel& chain, const Recording& recording);

/// The window that derivatives are taken over. Throws InputError for fewer than two rows.
ZeroPhaseWindow rigid_body_window(std::span<const Recording> recordings);

/// The physics of the first model that has fits; nullptr if none has.
const PhysicsModel* rigid_body_of(std::span<const TrainedModel> models);

/// Half of the window that derivatives are taken over (s); at least three samples. Between the UR5 recordings
/// No3, No5 and No6, 24 ms and 80 ms changed the error of the robot file's inertia, and of the inertia
/// identified on No6, by less than 5 % (geometric mean over the outputs).
inline constexpr double rigid_body_window_s = 0.04;

} // namespace dfdyn::tools
