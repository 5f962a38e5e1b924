// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include <algorithm>

namespace dfdyn::tests {

using namespace tools;

const std::vector<PanelRobot>& panel_robots() {
    static const std::vector<PanelRobot> robots{
        {"icub_wrench", "icub_right_arm/icub_right_arm.urdf", "r_hand", OutputKind::wrench, 2, 1.2},
        {"ur5_torque", "ur5/ur5_robot.urdf", "ee_link", OutputKind::joint_torque, 1.8, 1.6},
        {"ur5_current", "ur5/ur5_robot.urdf", "ee_link", OutputKind::motor_current, 1.8, 1.6},
        {"three_joint_torque", "three_joint_arm/three_joint_arm.urdf", "tool", OutputKind::joint_torque, 2.5,
         1.8},
    };
    return robots;
}

const PanelRobot& panel_robot(const std::string& name) {
    const auto found = std::ranges::find(panel_robots(), name, &PanelRobot::name);
    if (found == panel_robots().end()) {
        throw InputError("robot: expected one of the panel's, found " + name);
    }
    return *found;
}

std::vector<std::string> panel_robot_names() {
    std::vector<std::string> names;
    for (const PanelRobot& robot : panel_robots()) {
        names.push_back(robot.name);
    }
    return names;
}

Robot read_panel_robot(const PanelRobot& robot) {
    ReadRobotOptions options;
    options.tip = robot.tip;
    return read_robot(std::string(DFDYN_TEST_DATA_DIR) + "/robots/" + robot.urdf, options);
}

} // namespace dfdyn::tests
