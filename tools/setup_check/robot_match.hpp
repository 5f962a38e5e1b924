// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Detects a robot's file that does not belong to the recording: a mistake if smooth functions of the motion
/// explain the outputs of the joints that carry weight far better than the file's rigid body with any payload
/// does, and the file leaves much. Each joint is compared in the rows in which it moves, if they are
/// enough for so many functions. Joints without gravity in the file, and wrenches, are not compared. Cost:
/// T (8 n)^2 per output.
SetupFindings check_robot_match(const ArmRecording& arm);

} // namespace dfdyn::tools
