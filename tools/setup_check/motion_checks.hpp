// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/motion.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Finds outputs that push a joint along where friction must brake it, without a robot: a mistake where
/// friction_sign() says so.
SetupFindings check_friction_sign(const Recording& recording, const RecordedMotion& recorded);

/// Finds positions of one or two joints beyond two turns that are in degrees: a mistake where gravity as a
/// function of angles in degrees leaves less than half of the outputs' variance that it leaves in radians.
SetupFindings check_degrees_by_gravity(const Recording& recording, const RecordedMotion& recorded);

} // namespace dfdyn::tools
