// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/inverse_kinematics.hpp"

#include <Eigen/Cholesky>

namespace dfdyn::tools {

InverseKinematics::InverseKinematics(const Robot& robot)
    : dynamics_(robot, JointVector::Zero(static_cast<Eigen::Index>(robot.joints.size()))) {}

Eigen::Vector3d InverseKinematics::tip(const JointVector& position) {
    dynamics_.configure(position, configuration_);
    return dynamics_.tip(configuration_);
}

JointVector InverseKinematics::move(const JointVector& position, const Eigen::Vector3d& tip_motion,
                                    const JointVector& pull) {
    constexpr double damping = 1e-3; // m per rad: far below the Jacobian's singular values in use
    dynamics_.configure(position, configuration_);
    const PointJacobian jacobian = dynamics_.tip_jacobian(configuration_);
    const Eigen::Matrix3d square =
        jacobian * jacobian.transpose() + damping * damping * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d remaining = tip_motion - jacobian * pull;
    return pull + jacobian.transpose() * square.llt().solve(remaining);
}

JointVector InverseKinematics::reach(JointVector position, const Eigen::Vector3d& target,
                                     const JointVector& rest) {
    constexpr int iterations = 300;
    constexpr double largest_step = 0.2; // rad, per joint: keeps a far target from being overshot
    for (int i = 0; i < iterations; ++i) {
        const Eigen::Vector3d remaining = target - tip(position);
        JointVector step = move(position, remaining, 0.1 * (rest - position));
        const double largest = step.cwiseAbs().maxCoeff();
        if (largest > largest_step) {
            step *= largest_step / largest;
        }
        position += step;
    }
    return position;
}

} // namespace dfdyn::tools
