// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

namespace dfdyn::tests {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Force and torque that the base's side of the robot's sensor exerts on the tip's side in a motion, in the
/// sensor's frame, by DART.
Wrench dart_wrench(const tools::Robot& robot, const Eigen::VectorXd& xi);

} // namespace dfdyn::tests
