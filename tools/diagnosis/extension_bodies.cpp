// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension_parts.hpp"

#include "tools/robot/inertia.hpp"

#include <Eigen/Geometry>

namespace dfdyn::tools {

namespace {

using Eigen::Vector3d;
using How = CarriedFinding::How;

InertialParameters point_mass(double mass, const Vector3d& centre) {
    return body_parameters(mass, centre, Eigen::Matrix3d::Zero());
}

} // namespace

How add_payload(Extension& extension, const ChosenEffect& chosen) {
    const double mass = chosen.coefficients[0];
    const Vector3d centre =
        chosen.coefficients.size() == 4 ? Vector3d(chosen.coefficients.tail<3>() / mass) : Vector3d::Zero();
    extension.bodies.tail<10>() += moved(point_mass(mass, centre), extension.robot.tip_placement);
    return How::adapting;
}

/// The point mass that the model has at the link's centre of mass becomes heavier, and moves.
How add_link_error(Extension& extension, const ChosenEffect& chosen) {
    const Eigen::Index bodies = extension.bodies.size() / 10;
    const Eigen::Index body =
        chosen.number() - (static_cast<Eigen::Index>(extension.robot.joints.size()) - bodies);
    auto parameters = extension.bodies.segment<10>(10 * body);
    const bool with_mass = chosen.shape.columns.front() == 0;
    const double mass = parameters[0];
    const double found_mass = mass + (with_mass ? chosen.coefficients[0] : 0);
    const Vector3d centre = mass > 0 ? Vector3d(parameters.segment<3>(1) / mass) : Vector3d::Zero();
    const Vector3d moment =
        chosen.coefficients.size() > 1 ? Vector3d(chosen.coefficients.tail<3>()) : Vector3d::Zero();
    if (!(found_mass > 0)) {
        return How::left_out;
    }
    parameters += point_mass(found_mass, centre + moment / found_mass) - point_mass(mass, centre);
    return How::adapting;
}

/// A base that turns by +tilt sees gravity turned by -tilt.
How add_tilt(Extension& extension, const ChosenEffect& chosen) {
    extension.robot.gravity =
        Eigen::AngleAxisd(-chosen.coefficients[0], Vector3d::UnitX()) *
        (Eigen::AngleAxisd(-chosen.coefficients[1], Vector3d::UnitY()) * extension.robot.gravity);
    return How::fixed;
}

/// The joint's zero moves by the offset, so that the measured position means the true one.
How add_encoder_offset(Extension& extension, const ChosenEffect& chosen) {
    RobotJoint& joint = extension.robot.joints[static_cast<std::size_t>(chosen.number())];
    const double offset = chosen.coefficients[0];
    if (joint.prismatic) {
        joint.placement.translate(-offset * joint.axis);
    } else {
        joint.placement.rotate(Eigen::AngleAxisd(-offset, joint.axis));
    }
    return How::fixed;
}

/// Measured = rotation · true: the frame that is measured in sits turned by the inverse.
How add_rotation(Extension& extension, const ChosenEffect& chosen) {
    Vector3d angles = Vector3d::Zero();
    for (Eigen::Index i = 0; i < chosen.coefficients.size(); ++i) {
        angles[static_cast<Eigen::Index>(chosen.shape.columns[static_cast<std::size_t>(i)])] =
            chosen.coefficients[i];
    }
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(angles[2], Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(angles[1], Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(angles[0], Vector3d::UnitX());
    extension.robot.sensor->placement.rotate(rotation.conjugate());
    return How::fixed;
}

} // namespace dfdyn::tools
