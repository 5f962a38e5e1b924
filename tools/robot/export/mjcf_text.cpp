// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/robot/export/robot_export.hpp"

namespace dfdyn::tools {

namespace {

std::string quoted(const char* name, const std::string& value) {
    return std::string(" ").append(name).append("=\"").append(value).append("\"");
}

std::string pose(const Eigen::Isometry3d& placement) {
    const Eigen::Quaterniond turn(placement.linear());
    return quoted("pos", spaced(placement.translation())) +
           quoted("quat", spaced(Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z())));
}

std::string inertial(const InertialParameters& parameters) {
    const CentralBody body = central_body(parameters);
    const Eigen::Matrix3d& i = body.inertia;
    Eigen::VectorXd elements(6);
    elements << i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2);
    return "<inertial" + quoted("pos", spaced(body.centre)) + quoted("mass", number_text(body.mass)) +
           quoted("fullinertia", spaced(elements)) + "/>";
}

std::string hinge_or_slide(const RobotJoint& joint, const JointDynamics& dynamics) {
    std::string text = "<joint" + quoted("name", joint.name) +
                       quoted("type", joint.prismatic ? "slide" : "hinge") +
                       quoted("axis", spaced(joint.axis));
    if (joint.lower && joint.upper) {
        text += quoted("range", spaced(Eigen::Vector2d(*joint.lower, *joint.upper)));
    }
    return text + quoted("damping", number_text(dynamics.damping)) +
           quoted("frictionloss", number_text(dynamics.friction)) +
           quoted("armature", number_text(dynamics.armature)) + "/>";
}

} // namespace

std::string mjcf_text(const RobotExport& exported) {
    const Robot& robot = exported.robot;
    // boundmass and boundinertia: the simulator refuses moving links without mass
    std::string text = "<mujoco" + quoted("model", robot.name) +
                       ">\n<compiler angle=\"radian\" autolimits=\"true\" boundmass=\"1e-6\" "
                       "boundinertia=\"1e-9\"/>\n<option" +
                       quoted("gravity", spaced(robot.gravity)) + "/>\n<worldbody>\n<body" +
                       quoted("name", robot.base) + ">\n";
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        text += "<body" + quoted("name", joint.link) + pose(joint.placement) + ">\n" +
                inertial(joint.inertia) + "\n" + hinge_or_slide(joint, exported.joints[i]) + "\n";
    }
    text += "<site" + quoted("name", robot.tip) + pose(robot.tip_placement) + "/>\n";
    for (std::size_t i = 0; i <= robot.joints.size(); ++i) {
        text += "</body>\n";
    }
    return text + "</worldbody>\n</mujoco>\n";
}

} // namespace dfdyn::tools
