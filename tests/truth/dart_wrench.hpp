// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

namespace dfdyn::tests {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Force and torque that the base side of the robot's sensor exerts on the tip side during a motion, in the
/// sensor's frame, computed by DART.
Wrench dart_wrench(const tools::Robot& robot, const Eigen::VectorXd& xi);

/// Joint accelerations under these torques, computed by DART. The robot must have a sensor. The body that
/// carries it has the mass of `inertia_beyond` in addition to its own.
Eigen::VectorXd dart_acceleration(const tools::Robot& robot, const Eigen::VectorXd& position,
                                  const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque);

} // namespace dfdyn::tests
