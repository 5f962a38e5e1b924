// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/robot.hpp"

#include <string>

namespace dfdyn::tools {

/// Throws InputError `WHERE joint NAME: ...` when a joint of `position` is beyond one of the robot's limits:
/// which, where the limit is and by how much it is exceeded.
void check_limits(const Robot& robot, const JointVector& position, const std::string& where);

/// `upper limit 1.85 rad`.
std::string limit_text(const RobotJoint& joint, const std::string& name, double limit);

} // namespace dfdyn::tools
