// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/extension/extension.hpp"
#include "tools/robot/export/robot_export.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the robot that the diagnosis found: masses, centres of mass, moments of inertia, gravity and
/// offsets of the encoders; viscous and dry friction and the rotor's inertia of each joint. `left_out` names
/// what a robot file cannot contain, such as a gain, and links with physically impossible parameters, which
/// keep those of the file. `formats`: names of the robot_formats() to be written; a URDF contains no gravity.
RobotExport corrected_robot(const ModelExtension& extension, const std::vector<std::string>& formats);

} // namespace dfdyn::tools
