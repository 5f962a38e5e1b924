// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/robot/export/robot_export.hpp"
#include "tools/robot/export/xml_element.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

using tinyxml2::XMLPrinter;

/// Magnitude of a limit that the robot's description does not have, because URDF requires one.
constexpr double no_limit = 1000;

/// Roll, pitch and yaw: rotations about the fixed axes x, y, z, in this order.
Eigen::Vector3d fixed_axis_angles(const Eigen::Matrix3d& rotation) {
    const double pitch = std::asin(std::clamp(-rotation(2, 0), -1.0, 1.0));
    constexpr double upright = 1 - 1e-12; // x along z: roll and yaw turn about the same axis
    if (std::abs(rotation(2, 0)) > upright) {
        return {0, pitch, std::atan2(-rotation(0, 1), rotation(1, 1))};
    }
    return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch, std::atan2(rotation(1, 0), rotation(0, 0))};
}

void print_link(XMLPrinter& out, const std::string& name, const InertialParameters& parameters) {
    XmlElement link(out, "link");
    link.set("name", name);
    if (parameters.isZero(0)) {
        return;
    }
    const CentralBody body = central_body(parameters);
    const auto moment = [&](Eigen::Index row, Eigen::Index column) {
        return number_text(body.inertia(row, column));
    };
    const XmlElement inertial(out, "inertial");
    XmlElement(out, "origin").set("xyz", spaced(body.centre));
    XmlElement(out, "mass").set("value", number_text(body.mass));
    XmlElement(out, "inertia")
        .set("ixx", moment(0, 0))
        .set("ixy", moment(0, 1))
        .set("ixz", moment(0, 2))
        .set("iyy", moment(1, 1))
        .set("iyz", moment(1, 2))
        .set("izz", moment(2, 2));
}

/// Prints what all joints have: name, type, links and origin.
void print_connection(XMLPrinter& out, XmlElement& joint, const std::string& name, const char* type,
                      const std::string& parent, const std::string& child,
                      const Eigen::Isometry3d& placement) {
    joint.set("name", name).set("type", type);
    XmlElement(out, "parent").set("link", parent);
    XmlElement(out, "child").set("link", child);
    XmlElement(out, "origin")
        .set("xyz", spaced(placement.translation()))
        .set("rpy", spaced(fixed_axis_angles(placement.linear())));
}

void print_fixed_joint(XMLPrinter& out, const std::string& parent, const std::string& child,
                       const Eigen::Isometry3d& placement) {
    XmlElement joint(out, "joint");
    print_connection(out, joint, parent + "_to_" + child, "fixed", parent, child, placement);
}

void print_limits(XMLPrinter& out, const RobotJoint& joint) {
    XmlElement limit(out, "limit");
    if ((joint.lower && joint.upper) || joint.prismatic) {
        limit.set("lower", number_text(joint.lower.value_or(-no_limit)))
            .set("upper", number_text(joint.upper.value_or(no_limit)));
    }
    limit.set("effort", number_text(joint.effort.value_or(no_limit)))
        .set("velocity", number_text(joint.velocity.value_or(no_limit)));
}

void print_moving_joint(XMLPrinter& out, const RobotJoint& joint, const JointDynamics& dynamics,
                        const std::string& parent) {
    const bool bounded = joint.lower && joint.upper;
    const char* const type = joint.prismatic ? "prismatic" : bounded ? "revolute" : "continuous";
    XmlElement element(out, "joint");
    print_connection(out, element, joint.name, type, parent, joint.link, joint.placement);
    XmlElement(out, "axis").set("xyz", spaced(joint.axis));
    print_limits(out, joint);
    XmlElement(out, "dynamics")
        .set("damping", number_text(dynamics.damping))
        .set("friction", number_text(dynamics.friction));
}

/// Returns the shortest rotation from `direction` to -z; from z, half a turn about x. Eigen's FromTwoVectors
/// does the same with a singular value decomposition, which takes seconds to compile.
Eigen::Matrix3d turn_to_negative_z(const Eigen::Vector3d& direction) {
    const Eigen::Vector3d from = direction.normalized();
    const double cosine = -from.z();
    if (cosine < -1 + 1e-12) {
        return Eigen::Quaterniond(0, -1, 0, 0).toRotationMatrix();
    }
    const double scale = std::sqrt(2 * (1 + cosine));
    const Eigen::Vector3d axis = from.cross(-Eigen::Vector3d::UnitZ()) * (1 / scale);
    return Eigen::Quaterniond(scale / 2, axis.x(), axis.y(), axis.z()).toRotationMatrix();
}

/// Prints a root link with an upward z axis, unless the z axis of the robot's base points up.
void print_gravity_frame(XMLPrinter& out, const Robot& robot) {
    const Eigen::Vector3d down = robot.gravity.normalized();
    if (robot.gravity.norm() > 0 && (down + Eigen::Vector3d::UnitZ()).norm() > 1e-12) {
        Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
        turned.linear() = turn_to_negative_z(down);
        print_link(out, "gravity_frame", InertialParameters::Zero());
        print_fixed_joint(out, "gravity_frame", robot.base, turned);
    }
}

void print_robot(XMLPrinter& out, const RobotExport& exported) {
    const Robot& robot = exported.robot;
    XmlElement element(out, "robot");
    element.set("name", robot.name);
    print_gravity_frame(out, robot);
    print_link(out, robot.base, InertialParameters::Zero());
    std::string parent = robot.base;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        print_moving_joint(out, robot.joints[i], exported.joints[i], parent);
        parent = robot.joints[i].link;
        print_link(out, parent, robot.joints[i].inertia);
    }
    if (parent != robot.tip) {
        print_fixed_joint(out, parent, robot.tip, robot.tip_placement);
        print_link(out, robot.tip, InertialParameters::Zero());
    }
}

} // namespace

std::string urdf_text(const RobotExport& exported) {
    XMLPrinter out;
    out.PushHeader(false, true);
    print_robot(out, exported);
    return out.CStr();
}

} // namespace dfdyn::tools
