// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/robot/export/robot_export.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

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

std::string origin(const Eigen::Isometry3d& placement) {
    return "<origin" + attribute("xyz", spaced(placement.translation())) +
           attribute("rpy", spaced(fixed_axis_angles(placement.linear()))) + "/>";
}

std::string link(const std::string& name, const InertialParameters& parameters) {
    if (parameters.isZero(0)) {
        return "  <link" + attribute("name", name) + "/>\n";
    }
    const CentralBody body = central_body(parameters);
    const auto element = [&](const char* axes, Eigen::Index row, Eigen::Index column) {
        return attribute(axes, number_text(body.inertia(row, column)));
    };
    return "  <link" + attribute("name", name) + ">\n    <inertial>\n      <origin" +
           attribute("xyz", spaced(body.centre)) + "/>\n      <mass" +
           attribute("value", number_text(body.mass)) + "/>\n      <inertia" + element("ixx", 0, 0) +
           element("ixy", 0, 1) + element("ixz", 0, 2) + element("iyy", 1, 1) + element("iyz", 1, 2) +
           element("izz", 2, 2) + "/>\n    </inertial>\n  </link>\n";
}

/// The beginning of a joint's element: name, type, links and origin.
std::string joint_between(const std::string& name, const std::string& type, const std::string& parent,
                          const std::string& child, const Eigen::Isometry3d& placement) {
    return "  <joint" + attribute("name", name) + attribute("type", type) + ">\n    <parent" +
           attribute("link", parent) + "/>\n    <child" + attribute("link", child) + "/>\n    " +
           origin(placement) + "\n";
}

std::string fixed_joint(const std::string& parent, const std::string& child,
                        const Eigen::Isometry3d& placement) {
    return joint_between(parent + "_to_" + child, "fixed", parent, child, placement) + "  </joint>\n";
}

std::string moving_joint(const RobotJoint& joint, const JointDynamics& dynamics, const std::string& parent) {
    const bool bounded = joint.lower && joint.upper;
    std::string limit;
    if (bounded || joint.prismatic) {
        limit = attribute("lower", number_text(joint.lower.value_or(-no_limit))) +
                attribute("upper", number_text(joint.upper.value_or(no_limit)));
    }
    limit += attribute("effort", number_text(joint.effort.value_or(no_limit))) +
             attribute("velocity", number_text(joint.velocity.value_or(no_limit)));
    const char* const type = joint.prismatic ? "prismatic" : bounded ? "revolute" : "continuous";
    return joint_between(joint.name, type, parent, joint.link, joint.placement) + "    <axis" +
           attribute("xyz", spaced(joint.axis)) + "/>\n    <limit" + limit + "/>\n    <dynamics" +
           attribute("damping", number_text(dynamics.damping)) +
           attribute("friction", number_text(dynamics.friction)) + "/>\n  </joint>\n";
}

} // namespace

std::string urdf_text(const RobotExport& exported) {
    const Robot& robot = exported.robot;
    std::string text = "<?xml version=\"1.0\"?>\n<robot" + attribute("name", robot.name) + ">\n";
    const Eigen::Vector3d down = robot.gravity.normalized();
    if (robot.gravity.norm() > 0 && (down + Eigen::Vector3d::UnitZ()).norm() > 1e-12) {
        Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
        turned.linear() =
            Eigen::Quaterniond::FromTwoVectors(down, -Eigen::Vector3d::UnitZ()).toRotationMatrix();
        text += link("gravity_frame", InertialParameters::Zero()) +
                fixed_joint("gravity_frame", robot.base, turned);
    }
    text += link(robot.base, InertialParameters::Zero());
    std::string parent = robot.base;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        text += moving_joint(robot.joints[i], exported.joints[i], parent);
        parent = robot.joints[i].link;
        text += link(parent, robot.joints[i].inertia);
    }
    if (parent != robot.tip) {
        text +=
            fixed_joint(parent, robot.tip, robot.tip_placement) + link(robot.tip, InertialParameters::Zero());
    }
    return text + "</robot>\n";
}

} // namespace dfdyn::tools
