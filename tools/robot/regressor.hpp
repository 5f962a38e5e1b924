// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

namespace dfdyn::tools {

/// The rigid-body regressor of every state, stacked: rows t m + k for output k of state t, columns in the
/// order of `nominal_parameters`; evaluated by the firmware's own code in double. Outputs of motor current:
/// the torques' regressor. Throws std::logic_error for a wrench when the robot has no sensor.
Eigen::MatrixXd stacked_regressor(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

/// The outputs, T x m, that a stacked vector holds.
Eigen::MatrixXd unstacked(const Eigen::VectorXd& stacked, Eigen::Index outputs);

/// The inverse of `unstacked`.
Eigen::VectorXd stacked(const Eigen::MatrixXd& outputs);

} // namespace dfdyn::tools
