// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/robot/export/robot_export.hpp"
#include "tools/robot/export/xml_element.hpp"

namespace dfdyn::tools {

namespace {

using tinyxml2::XMLPrinter;

void set_pose(XmlElement& element, const Eigen::Isometry3d& placement) {
    const Eigen::Quaterniond turn(placement.linear());
    element.set("pos", spaced(placement.translation()))
        .set("quat", spaced(Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z())));
}

void print_inertial(XMLPrinter& out, const InertialParameters& parameters) {
    if (parameters.isZero(0)) {
        return;
    }
    const CentralBody body = central_body(parameters);
    const Eigen::Matrix3d& i = body.inertia;
    Eigen::VectorXd elements(6);
    elements << i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2);
    XmlElement(out, "inertial")
        .set("pos", spaced(body.centre))
        .set("mass", number_text(body.mass))
        .set("fullinertia", spaced(elements));
}

void print_joint(XMLPrinter& out, const RobotJoint& joint, const JointDynamics& dynamics) {
    XmlElement element(out, "joint");
    element.set("name", joint.name)
        .set("type", joint.prismatic ? "slide" : "hinge")
        .set("axis", spaced(joint.axis));
    if (joint.lower && joint.upper) {
        element.set("range", spaced(Eigen::Vector2d(*joint.lower, *joint.upper)));
    }
    element.set("damping", number_text(dynamics.damping))
        .set("frictionloss", number_text(dynamics.friction))
        .set("armature", number_text(dynamics.armature));
}

/// Prints the links from `first` on, each within the one before, and the tip within the last.
void print_links(XMLPrinter& out, const RobotExport& exported, std::size_t first) {
    const Robot& robot = exported.robot;
    if (first == robot.joints.size()) {
        XmlElement site(out, "site");
        site.set("name", robot.tip);
        set_pose(site, robot.tip_placement);
        return;
    }
    const RobotJoint& joint = robot.joints[first];
    XmlElement body(out, "body");
    body.set("name", joint.link);
    set_pose(body, joint.placement);
    print_inertial(out, joint.inertia);
    print_joint(out, joint, exported.joints[first]);
    print_links(out, exported, first + 1);
}

void print_model(XMLPrinter& out, const RobotExport& exported) {
    XmlElement model(out, "mujoco");
    model.set("model", exported.robot.name);
    // boundmass and boundinertia: the simulator refuses moving links without mass
    XmlElement(out, "compiler")
        .set("angle", "radian")
        .set("autolimits", "true")
        .set("boundmass", "1e-6")
        .set("boundinertia", "1e-9");
    XmlElement(out, "option").set("gravity", spaced(exported.robot.gravity));
    const XmlElement world(out, "worldbody");
    XmlElement base(out, "body");
    base.set("name", exported.robot.base);
    print_links(out, exported, 0);
}

} // namespace

std::string mjcf_text(const RobotExport& exported) {
    XMLPrinter out;
    print_model(out, exported);
    return out.CStr();
}

} // namespace dfdyn::tools
