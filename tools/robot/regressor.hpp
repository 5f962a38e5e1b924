// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

namespace dfdyn::tools {

/// Returns the rigid-body regressor of all states, stacked: row t m + k for output k of state t, columns in
/// the order of `nominal_parameters`. It is evaluated by the firmware's code in double. For motor currents it
/// is the torques' regressor. Throws std::logic_error for a wrench if the robot has no sensor.
Eigen::MatrixXd stacked_regressor(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

/// Returns the outputs, T x m, of a stacked vector.
Eigen::MatrixXd unstacked(const Eigen::VectorXd& stacked, Eigen::Index outputs);

/// Returns the inverse of `unstacked`.
Eigen::VectorXd stacked(const Eigen::MatrixXd& outputs);

} // namespace dfdyn::tools
