// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/rigid_model.hpp"

#include "tools/robot/dynamics/arm_dynamics.hpp"

namespace dfdyn::tools {

Eigen::MatrixXd rigid_outputs(const Robot& robot, OutputKind outputs, const RobotMotion& motion) {
    const auto joints = static_cast<Eigen::Index>(robot.joints.size());
    const ArmDynamics dynamics(robot, JointVector::Zero(joints));
    const bool wrench = outputs == OutputKind::wrench;
    Eigen::MatrixXd result(motion.rows(), wrench ? 6 : joints);
    ArmDynamics::Configuration configuration;
    for (Eigen::Index row = 0; row < motion.rows(); ++row) {
        const JointVector velocity = motion.velocity.row(row);
        const JointVector acceleration = motion.acceleration.row(row);
        dynamics.configure(motion.position.row(row), configuration);
        if (wrench) {
            result.row(row) = dynamics.wrench(configuration, velocity, acceleration);
        } else {
            result.row(row) = dynamics.inverse(configuration, velocity, acceleration);
        }
    }
    return result;
}

Eigen::MatrixXd joint_inertias(const Robot& robot, const RobotMotion& motion) {
    const Eigen::Index joints = motion.position.cols();
    const ArmDynamics dynamics(robot, JointVector::Zero(joints));
    ArmDynamics::Configuration configuration;
    Eigen::MatrixXd result(motion.rows(), joints);
    for (Eigen::Index row = 0; row < motion.rows(); ++row) {
        dynamics.configure(motion.position.row(row), configuration);
        result.row(row) = dynamics.mass_matrix(configuration).diagonal();
    }
    return result;
}

Eigen::MatrixXd MotionSensitivity::of(std::size_t joint, const Eigen::VectorXd& change,
                                      const Eigen::VectorXd& change_velocity,
                                      const Eigen::VectorXd& change_acceleration) const {
    return change.asDiagonal() * position[joint] + change_velocity.asDiagonal() * velocity[joint] +
           change_acceleration.asDiagonal() * acceleration[joint];
}

MotionSensitivity motion_sensitivity(const Robot& robot, OutputKind outputs, const RobotMotion& motion) {
    MotionSensitivity result;
    RobotMotion changed = motion;
    const auto slope = [&](Eigen::MatrixXd& coordinate, Eigen::Index joint, double step) {
        const Eigen::VectorXd kept = coordinate.col(joint);
        coordinate.col(joint).array() += step;
        const Eigen::MatrixXd above = rigid_outputs(robot, outputs, changed);
        coordinate.col(joint) = kept.array() - step;
        const Eigen::MatrixXd below = rigid_outputs(robot, outputs, changed);
        coordinate.col(joint) = kept;
        return Eigen::MatrixXd((above - below) / (2 * step));
    };
    for (Eigen::Index joint = 0; joint < motion.position.cols(); ++joint) {
        result.position.push_back(slope(changed.position, joint, 1e-5));
        result.velocity.push_back(slope(changed.velocity, joint, 1e-4));
        result.acceleration.push_back(slope(changed.acceleration, joint, 1)); // exactly linear
    }
    return result;
}

} // namespace dfdyn::tools
