// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/robot.hpp"

#include <string>

namespace dfdyn::tools {

/// Throws InputError `WHERE joint NAME: ...` if a joint of `position` is beyond a limit of the robot: which
/// limit, its value, and the excess.
void check_limits(const Robot& robot, const JointVector& position, const std::string& where);

/// Throws InputError `t = TIME s: ...` if a position is not finite or a velocity exceeds 1e4 rad/s (m/s): the
/// simulation diverges.
void check_stable(const JointVector& position, const JointVector& velocity, double time_s);

/// Returns text like `upper limit 1.85 rad`.
std::string limit_text(const RobotJoint& joint, const std::string& name, double limit);

} // namespace dfdyn::tools
