// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/robot.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Dynamics of a joint in addition to the rigid body. Its torque is damping q̇ + friction sign(q̇) + armature
/// q̈.
struct JointDynamics {
    double damping = 0;  ///< N·m·s/rad (N·s/m), not negative
    double friction = 0; ///< N·m (N), not negative
    double armature = 0; ///< kg·m² (kg), not negative: inertia of the rotor, seen at the joint
};

/// A chain with the dynamics of its joints, for a simulator.
struct RobotExport {
    Robot robot;
    std::vector<JointDynamics> joints;
    std::vector<std::string> left_out; ///< parts of the model that no robot file can hold; one line each
};

/// A file format for robots. To add one, write one file in this folder and an entry in the list.
struct RobotFormat {
    const char* name; ///< value of `--export`
    const char* file;
    /// Returns the file's text: joints, inertias about the centres of mass, limits, and the tip's frame.
    /// Shapes are not part of it.
    std::string (*text)(const RobotExport& exported);
    bool holds_gravity; ///< false: simulators assume one of 9.81 m/s²
};

/// URDF. Gravity is along −z of the root link; a fixed joint turns the base if necessary. It has no armature.
std::string urdf_text(const RobotExport& exported);
/// MJCF of the simulator MuJoCo.
std::string mjcf_text(const RobotExport& exported);
/// JSON of schema `dfdyn.robot/1`, for scripts.
std::string robot_json_text(const RobotExport& exported);

/// Returns all formats.
const std::vector<RobotFormat>& robot_formats();

/// Returns numbers as text with a space between them. Each reads back as the same number.
std::string spaced(const Eigen::VectorXd& values);

} // namespace dfdyn::tools
