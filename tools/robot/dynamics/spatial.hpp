// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

#include <Eigen/Geometry>

namespace dfdyn::tools {

/// Angular velocity, and the linear velocity of the body's point at the base's origin: six-dimensional
/// vectors of R. Featherstone, "Rigid Body Dynamics Algorithms", 2008. All are in the base's frame, so that
/// bodies add without transforms.
struct SpatialMotion {
    Eigen::Vector3d angular = Eigen::Vector3d::Zero();
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();

    SpatialMotion operator+(const SpatialMotion& other) const {
        return {angular + other.angular, linear + other.linear};
    }
    SpatialMotion operator*(double factor) const { return {factor * angular, factor * linear}; }

    /// Returns the rate of `other` if it moves with this motion.
    SpatialMotion cross(const SpatialMotion& other) const {
        return {angular.cross(other.angular), angular.cross(other.linear) + linear.cross(other.angular)};
    }
};

/// Force, and torque about the base's origin.
struct SpatialForce {
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();

    SpatialForce operator+(const SpatialForce& other) const {
        return {torque + other.torque, force + other.force};
    }

    double power(const SpatialMotion& motion) const {
        return torque.dot(motion.angular) + force.dot(motion.linear);
    }

    /// Returns the rate of this force if it moves with `motion`.
    SpatialForce moved_by(const SpatialMotion& motion) const {
        return {motion.angular.cross(torque) + motion.linear.cross(force), motion.angular.cross(force)};
    }
};

/// Mass, first moment and inertia about the base's origin, in the base's frame.
struct SpatialInertia {
    double mass = 0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();

    SpatialInertia operator+(const SpatialInertia& other) const {
        return {mass + other.mass, moment + other.moment, inertia + other.inertia};
    }

    /// Returns the momentum of the body for this velocity, or the force for this acceleration from rest.
    SpatialForce operator*(const SpatialMotion& motion) const {
        return {inertia * motion.angular + moment.cross(motion.linear),
                mass * motion.linear + motion.angular.cross(moment)};
    }
};

/// Converts `body` from a frame at `placement` to the base's frame.
SpatialInertia at_base(const InertialParameters& body, const Eigen::Isometry3d& placement);

} // namespace dfdyn::tools
