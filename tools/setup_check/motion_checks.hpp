// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Detects outputs whose friction accelerates the joint instead of braking it, without a robot: a mistake if
/// friction_sign() confirms it.
SetupFindings check_friction_sign(const Recording& recording, const RecordedMotion& recorded);

/// Detects positions in degrees for one or two joints beyond two turns: a mistake if gravity as a function of
/// angles in degrees leaves less than half of the variance that it leaves in radians.
SetupFindings check_degrees_by_gravity(const Recording& recording, const RecordedMotion& recorded);

} // namespace dfdyn::tools
