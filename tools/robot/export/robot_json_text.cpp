// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/json_text.hpp"
#include "tools/robot/export/robot_export.hpp"

#include <nlohmann/json.hpp>

namespace dfdyn::tools {

namespace {

nlohmann::ordered_json json_array(const Eigen::VectorXd& values) {
    return std::vector<double>(values.begin(), values.end());
}

nlohmann::ordered_json frame(const Eigen::Isometry3d& placement) {
    const Eigen::Quaterniond turn(placement.linear());
    return {{"xyz", json_array(placement.translation())},
            {"quaternion_wxyz", json_array(Eigen::Vector4d(turn.w(), turn.x(), turn.y(), turn.z()))}};
}

nlohmann::ordered_json joint_json(const RobotJoint& joint, const JointDynamics& dynamics) {
    const CentralBody body = central_body(joint.inertia);
    const Eigen::Matrix3d& i = body.inertia;
    Eigen::VectorXd elements(6);
    elements << i(0, 0), i(0, 1), i(0, 2), i(1, 1), i(1, 2), i(2, 2);
    return {{"name", joint.name},
            {"link", joint.link},
            {"type", joint.prismatic ? "prismatic" : "revolute"},
            {"placement", frame(joint.placement)},
            {"axis", json_array(joint.axis)},
            {"mass", body.mass},
            {"centre_of_mass", json_array(body.centre)},
            {"inertia_xx_xy_xz_yy_yz_zz", json_array(elements)},
            {"damping", dynamics.damping},
            {"friction", dynamics.friction},
            {"armature", dynamics.armature}};
}

} // namespace

std::string robot_json_text(const RobotExport& exported) {
    const Robot& robot = exported.robot;
    nlohmann::ordered_json joints = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        joints.push_back(joint_json(robot.joints[i], exported.joints[i]));
    }
    const nlohmann::ordered_json json{{"schema", "dfdyn.robot/1"},
                                      {"name", robot.name},
                                      {"base", robot.base},
                                      {"tip", robot.tip},
                                      {"gravity", json_array(robot.gravity)},
                                      {"joints", std::move(joints)},
                                      {"tip_placement", frame(robot.tip_placement)},
                                      {"left_out", exported.left_out}};
    return json_text(json) + '\n';
}

} // namespace dfdyn::tools
