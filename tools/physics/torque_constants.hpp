// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"
#include "tools/training/training_data.hpp"

#include <vector>

namespace dfdyn::tools {

/// Motor currents per torque (A/N·m) of each joint, for which the robot file has nothing: least squares of
/// the measured current on the nominal rigid body's torque, viscous friction, Coulomb friction and an offset,
/// over all rows. `data` has velocities and accelerations. `sign_velocity`: of Coulomb friction (rad/s).
///
/// A joint whose nominal torque hardly explains its current (a wrist) has no gain of its own: below a third
/// or above three times the median of the positive ones it gets the median.
std::vector<double> estimate_torque_gains(const Robot& robot, const TrainingData& data, double sign_velocity);

} // namespace dfdyn::tools
