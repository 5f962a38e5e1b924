// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/inverse_kinematics.hpp"

#include "tools/simulation/arm/joint_limits.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr double before_limit = 0.01; // rad or m
constexpr double moves_freely = std::numeric_limits<double>::quiet_NaN();

/// Returns the joint with the largest violation of its bounds; -1 if there is none.
Eigen::Index worst(const JointVector& motion, const JointVector& low, const JointVector& high) {
    Eigen::Index result = -1;
    double most = 1e-12;
    for (Eigen::Index i = 0; i < motion.size(); ++i) {
        const double excess = std::max(low[i] - motion[i], motion[i] - high[i]);
        if (excess > most) {
            most = excess;
            result = i;
        }
    }
    return result;
}

} // namespace

InverseKinematics::InverseKinematics(const Robot& robot)
    : dynamics_(robot, JointVector::Zero(static_cast<Eigen::Index>(robot.joints.size()))),
      lower_(dynamics_.joint_count()), upper_(dynamics_.joint_count()) {
    for (Eigen::Index i = 0; i < lower_.size(); ++i) {
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        lower_[i] = joint.lower ? *joint.lower + before_limit : -std::numeric_limits<double>::max();
        upper_[i] = joint.upper ? *joint.upper - before_limit : std::numeric_limits<double>::max();
    }
}

Eigen::Vector3d InverseKinematics::tip(const JointVector& position) {
    dynamics_.configure(position, configuration_);
    return dynamics_.tip(configuration_);
}

/// `held`: the motion of joints at their bounds, NaN for the others.
JointVector InverseKinematics::solve(const Eigen::Vector3d& tip_motion, const JointVector& pull,
                                     const JointVector& held) const {
    constexpr double damping = 1e-3; // m per rad: far below the relevant singular values of the Jacobian
    JointVector fixed = pull;
    PointJacobian free = jacobian_;
    for (Eigen::Index i = 0; i < held.size(); ++i) {
        if (!std::isnan(held[i])) {
            fixed[i] = held[i];
            free.col(i).setZero();
        }
    }
    const Eigen::Matrix3d square = free * free.transpose() + damping * damping * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d remaining = tip_motion - jacobian_ * fixed;
    return fixed + free.transpose() * square.llt().solve(remaining);
}

JointVector InverseKinematics::move(const JointVector& position, const Eigen::Vector3d& tip_motion,
                                    const JointVector& pull, double approach) {
    dynamics_.configure(position, configuration_);
    jacobian_ = dynamics_.tip_jacobian(configuration_);
    const JointVector low = approach * (lower_ - position);
    const JointVector high = approach * (upper_ - position);
    JointVector held = JointVector::Constant(position.size(), moves_freely);
    JointVector motion = solve(tip_motion, pull, held);
    for (Eigen::Index at_bound = worst(motion, low, high); at_bound >= 0;
         at_bound = worst(motion, low, high)) {
        held[at_bound] = motion[at_bound] < low[at_bound] ? low[at_bound] : high[at_bound];
        motion = solve(tip_motion, pull, held);
    }
    return motion;
}

JointVector InverseKinematics::reach(JointVector position, const Eigen::Vector3d& target,
                                     const JointVector& rest) {
    constexpr int iterations = 200;
    constexpr double largest_step = 0.2; // rad, per joint: prevents overshoot for a distant target
    for (int i = 0; i < iterations; ++i) {
        JointVector step = move(position, target - tip(position), 0.1 * (rest - position), 0.5);
        const double largest = step.cwiseAbs().maxCoeff();
        if (largest > largest_step) {
            step *= largest_step / largest;
        }
        position += step;
    }
    return position;
}

std::string InverseKinematics::joints_at_limits(const JointVector& position) const {
    constexpr double near = 1e-3;
    std::string result;
    for (Eigen::Index i = 0; i < position.size(); ++i) {
        const RobotJoint& joint = dynamics_.robot().joints[static_cast<std::size_t>(i)];
        const bool low = position[i] < lower_[i] + near;
        if (low || position[i] > upper_[i] - near) {
            result += (result.empty() ? "" : " and ") + joint.name + " at its " +
                      limit_text(joint, low ? "lower" : "upper", low ? *joint.lower : *joint.upper);
        }
    }
    return result.empty() ? "no joint at a limit" : result;
}

} // namespace dfdyn::tools
