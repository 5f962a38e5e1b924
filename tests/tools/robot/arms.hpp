// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/urdf/read_robot.hpp"

#include <Eigen/Geometry>

namespace dfdyn::tests {

inline tools::Robot icub_right_arm() {
    tools::ReadRobotOptions options;
    options.base = "chest";
    options.tip = "r_hand";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf", options);
}

inline tools::Robot ur5() {
    tools::ReadRobotOptions options;
    options.base = "base_link";
    options.tip = "ee_link";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/ur5/ur5_robot.urdf", options);
}

inline tools::Robot small_arm() {
    tools::ReadRobotOptions options;
    options.tip = "tool";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf", options);
}

inline tools::Robot tx40() {
    tools::ReadRobotOptions options;
    options.tip = "tool0";
    return tools::read_robot(DFDYN_TEST_DATA_DIR "/robots/tx40/tx40.urdf", options);
}

/// Two links of length 1 m that turn about z, with the given gravity along -y.
inline tools::Robot planar_arm(double gravity) {
    tools::Robot robot;
    robot.joints.resize(2);
    for (tools::RobotJoint& joint : robot.joints) {
        joint.inertia = tools::body_parameters(1, {0.5, 0.1, 0}, 0.1 * Eigen::Matrix3d::Identity());
    }
    robot.joints[1].placement.translation() = Eigen::Vector3d::UnitX();
    robot.gravity = {0, -gravity, 0};
    return robot;
}

} // namespace dfdyn::tests
