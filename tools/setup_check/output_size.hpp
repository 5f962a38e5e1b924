// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Finds outputs in another unit by their size over the rigid body's, where that explains half of what
/// friction leaves: a mistake where two outputs or more agree (to a factor of 10) on 50 times too much or too
/// little; for an arm of one joint, and a wrench, 300 times; a warning where one joint of several shows 300
/// times. Currents of unknown torque constants: from 50 A/N·m, one joint alone from 200.
SetupFindings check_output_size(const ArmRecording& arm);

} // namespace dfdyn::tools
