// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/robot/export/robot_export.hpp"

namespace dfdyn::tools {

namespace {

std::string pose(const Eigen::Isometry3d& placement) {
    const Eigen::Quaterniond turn(placement.linear());
    return attribute("pos", spaced(placement.translation())) +
           attribute("quat", spaced(Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z())));
}

std::string inertial(const InertialParameters& parameters) {
    if (parameters.isZero(0)) {
        return {};
    }
    const CentralBody body = central_body(parameters);
    const Eigen::Matrix3d& i = body.inertia;
    Eigen::VectorXd elements(6);
    elements << i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2);
    return "<inertial" + attribute("pos", spaced(body.centre)) + attribute("mass", number_text(body.mass)) +
           attribute("fullinertia", spaced(elements)) + "/>";
}

std::string hinge_or_slide(const RobotJoint& joint, const JointDynamics& dynamics) {
    std::string text = "<joint" + attribute("name", joint.name) +
                       attribute("type", joint.prismatic ? "slide" : "hinge") +
                       attribute("axis", spaced(joint.axis));
    if (joint.lower && joint.upper) {
        text += attribute("range", spaced(Eigen::Vector2d(*joint.lower, *joint.upper)));
    }
    return text + attribute("damping", number_text(dynamics.damping)) +
           attribute("frictionloss", number_text(dynamics.friction)) +
           attribute("armature", number_text(dynamics.armature)) + "/>";
}

} // namespace

std::string mjcf_text(const RobotExport& exported) {
    const Robot& robot = exported.robot;
    // boundmass and boundinertia: the simulator refuses moving links without mass
    std::string text = "<mujoco" + attribute("model", robot.name) +
                       ">\n<compiler angle=\"radian\" autolimits=\"true\" boundmass=\"1e-6\" "
                       "boundinertia=\"1e-9\"/>\n<option" +
                       attribute("gravity", spaced(robot.gravity)) + "/>\n<worldbody>\n<body" +
                       attribute("name", robot.base) + ">\n";
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        text += "<body" + attribute("name", joint.link) + pose(joint.placement) + ">\n" +
                inertial(joint.inertia) + "\n" + hinge_or_slide(joint, exported.joints[i]) + "\n";
    }
    text += "<site" + attribute("name", robot.tip) + pose(robot.tip_placement) + "/>\n";
    for (std::size_t i = 0; i <= robot.joints.size(); ++i) {
        text += "</body>\n";
    }
    return text + "</worldbody>\n</mujoco>\n";
}

} // namespace dfdyn::tools
