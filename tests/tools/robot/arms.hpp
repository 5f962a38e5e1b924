// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/seed.hpp"
#include "tools/robot/read_robot.hpp"

#include <Eigen/Geometry>

#include <random>

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

/// Two links of length 1 m that turn about z; gravity along −y, or none.
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

/// A body that can be: point masses around its frame.
inline tools::InertialParameters random_body(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    tools::InertialParameters body = tools::InertialParameters::Zero();
    for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d at(normal(engine), normal(engine), normal(engine));
        body += tools::body_parameters(0.2 + std::abs(normal(engine)), 0.1 * at, Eigen::Matrix3d::Zero());
    }
    return body;
}

} // namespace dfdyn::tests
