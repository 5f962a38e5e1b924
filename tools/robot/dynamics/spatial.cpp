// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/dynamics/spatial.hpp"

namespace dfdyn::tools {

namespace {

/// -[a]×[b]×, the change of an inertia by a shift.
Eigen::Matrix3d shift(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.dot(b) * Eigen::Matrix3d::Identity() - b * a.transpose();
}

} // namespace

SpatialInertia at_base(const InertialParameters& body, const Eigen::Isometry3d& placement) {
    const Eigen::Matrix3d rotation = placement.linear();
    const Eigen::Vector3d origin = placement.translation();
    Eigen::Matrix3d about_frame;
    about_frame << body[4], body[5], body[6], body[5], body[7], body[8], body[6], body[8], body[9];
    const Eigen::Vector3d moment = rotation * body.segment<3>(1);
    SpatialInertia result;
    result.mass = body[0];
    result.moment = moment + body[0] * origin;
    result.inertia = rotation * about_frame * rotation.transpose() + shift(origin, moment) +
                     shift(moment, origin) + body[0] * shift(origin, origin);
    return result;
}

} // namespace dfdyn::tools
