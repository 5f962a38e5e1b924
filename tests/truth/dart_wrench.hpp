// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

namespace dfdyn::tests {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Force and torque that the base's side of the robot's sensor exerts on the tip's side in a motion, in the
/// sensor's frame, by DART.
Wrench dart_wrench(const tools::Robot& robot, const Eigen::VectorXd& xi);

/// Joint accelerations under these torques, by DART. The body that carries the robot's sensor has the mass of
/// `inertia_beyond` on top of its own; the robot must have a sensor.
Eigen::VectorXd dart_acceleration(const tools::Robot& robot, const Eigen::VectorXd& position,
                                  const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque);

} // namespace dfdyn::tests
