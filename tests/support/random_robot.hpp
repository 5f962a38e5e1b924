// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/physics/chain.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/robot/robot.hpp"

#include <random>
#include <string>

namespace dfdyn::tests {

inline double uniform(std::mt19937_64& engine, double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(engine);
}

inline Eigen::Vector3d random_vector(std::mt19937_64& engine, double size) {
    return Eigen::Vector3d::NullaryExpr([&] { return uniform(engine, -size, size); });
}

inline Eigen::Matrix3d random_rotation(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    const Eigen::Vector4d components = Eigen::Vector4d::NullaryExpr([&] { return normal(engine); });
    return Eigen::Quaterniond(components.normalized()).toRotationMatrix();
}

inline Eigen::Isometry3d random_placement(std::mt19937_64& engine) {
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    placement.linear() = random_rotation(engine);
    placement.translation() = random_vector(engine, 0.5);
    return placement;
}

/// A body by mass, centre and central inertia.
struct Body {
    double mass;
    Eigen::Vector3d centre;          ///< centre of mass
    Eigen::Matrix3d central_inertia; ///< about the centre of mass

    [[nodiscard]] tools::InertialParameters parameters() const {
        const Eigen::Matrix3d shift =
            centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose();
        const Eigen::Matrix3d inertia = central_inertia + mass * shift;
        tools::InertialParameters result;
        result << mass, mass * centre, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
            inertia(1, 2), inertia(2, 2);
        return result;
    }
};

/// The body with these parameters.
inline Body body_of(const tools::InertialParameters& parameters) {
    const double mass = parameters[0];
    const Eigen::Vector3d centre = parameters.segment<3>(1) / mass;
    Eigen::Matrix3d inertia;
    inertia << parameters[4], parameters[5], parameters[6], parameters[5], parameters[7], parameters[8],
        parameters[6], parameters[8], parameters[9];
    return {mass, centre,
            inertia -
                mass * (centre.squaredNorm() * Eigen::Matrix3d::Identity() - centre * centre.transpose())};
}

/// A physically possible random body: its second moments of mass are positive along any axis.
inline Body random_body(std::mt19937_64& engine) {
    const Eigen::Vector3d moments = Eigen::Vector3d::NullaryExpr([&] { return uniform(engine, 0.01, 0.2); });
    const Eigen::Matrix3d axes = random_rotation(engine);
    const Eigen::Matrix3d second_moments = axes * moments.asDiagonal() * axes.transpose();
    return {uniform(engine, 0.5, 5), random_vector(engine, 0.3),
            second_moments.trace() * Eigen::Matrix3d::Identity() - second_moments};
}

/// n revolute and prismatic joints in random places, and gravity in a random direction.
inline tools::Robot random_robot(std::mt19937_64& engine, int n) {
    tools::Robot robot;
    robot.gravity = random_vector(engine, 9.81);
    for (int i = 0; i < n; ++i) {
        tools::RobotJoint joint;
        joint.name = "joint" + std::to_string(i + 1);
        joint.link = "link" + std::to_string(i + 1);
        joint.prismatic = uniform(engine, 0, 1) < 0.3;
        joint.placement = random_placement(engine);
        joint.axis = random_rotation(engine).col(0);
        joint.inertia = random_body(engine).parameters();
        robot.joints.push_back(joint);
    }
    return robot;
}

/// Random (q, q̇, q̈) of n joints.
inline Eigen::VectorXd random_motion(std::mt19937_64& engine, int n) {
    return Eigen::VectorXd::NullaryExpr(3L * n, [&] { return uniform(engine, -3, 3); });
}

inline Placement<double> placement_of(const Eigen::Isometry3d& isometry) {
    Placement<double> placement{};
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(placement.rotation) = isometry.linear();
    Eigen::Map<Eigen::Vector3d>(placement.translation) = isometry.translation();
    return placement;
}

/// The firmware's constants of a robot, except those of the output.
template <class Arm>
typename Arm::template Constants<double> chain_of(const tools::Robot& robot) {
    typename Arm::template Constants<double> chain{};
    const int n = static_cast<int>(robot.joints.size());
    chain.joint = decltype(chain.joint)::zeros(extent<Arm::joints>(n));
    for (int i = 0; i < n; ++i) {
        const tools::RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        chain.joint[i] = {
            placement_of(joint.placement), {joint.axis.x(), joint.axis.y(), joint.axis.z()}, joint.prismatic};
    }
    Eigen::Map<Eigen::Vector3d>(chain.gravity) = robot.gravity;
    return chain;
}

} // namespace dfdyn::tests
