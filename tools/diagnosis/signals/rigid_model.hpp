// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// The rigid body's outputs along a motion: joint torques (N·m; also where currents were measured) or the
/// wrench at the sensor. T x m. Cost: T times one recursive Newton-Euler pass.
Eigen::MatrixXd rigid_outputs(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

/// T x n, kg·m² (kg): the diagonal of the mass matrix along a motion.
Eigen::MatrixXd joint_inertias(const Robot& robot, const RobotMotion& motion);

/// How the outputs answer to small changes of the motion, joint by joint (T x m each; central differences).
struct MotionSensitivity {
    std::vector<Eigen::MatrixXd> position, velocity, acceleration; ///< per joint

    /// The change of the outputs when the position of `joint` were `change` (per row) larger, and its
    /// derivatives too.
    Eigen::MatrixXd of(std::size_t joint, const Eigen::VectorXd& change,
                       const Eigen::VectorXd& change_velocity,
                       const Eigen::VectorXd& change_acceleration) const;
};

MotionSensitivity motion_sensitivity(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

} // namespace dfdyn::tools
