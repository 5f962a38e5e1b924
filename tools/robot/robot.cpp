// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/robot.hpp"

namespace dfdyn::tools {

std::vector<std::string> names_of_joints(const Robot& robot) {
    std::vector<std::string> names;
    for (const RobotJoint& joint : robot.joints) {
        names.push_back(joint.name);
    }
    return names;
}

std::vector<bool> prismatic_joints(const Robot& robot) {
    std::vector<bool> result;
    for (const RobotJoint& joint : robot.joints) {
        result.push_back(joint.prismatic);
    }
    return result;
}

} // namespace dfdyn::tools
