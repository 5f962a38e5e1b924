// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/robot.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Returns the rigid body's outputs (T x m) along a motion: joint torques (N·m, also where currents were
/// measured) or the wrench at the sensor. Cost: T recursive Newton-Euler passes.
Eigen::MatrixXd rigid_outputs(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

/// Returns the diagonal of the mass matrix along a motion: T x n, kg·m² (kg).
Eigen::MatrixXd joint_inertias(const Robot& robot, const RobotMotion& motion);

/// Derivatives of the outputs with respect to the motion of each joint (T x m each), by central differences.
struct MotionSensitivity {
    std::vector<Eigen::MatrixXd> position, velocity, acceleration; ///< per joint

    /// Returns the change of the outputs if the position of `joint` is increased by `change` (per row), and
    /// its derivatives by the two other changes.
    Eigen::MatrixXd of(std::size_t joint, const Eigen::VectorXd& change,
                       const Eigen::VectorXd& change_velocity,
                       const Eigen::VectorXd& change_acceleration) const;
};

MotionSensitivity motion_sensitivity(const Robot& robot, OutputKind outputs, const RobotMotion& motion);

} // namespace dfdyn::tools
