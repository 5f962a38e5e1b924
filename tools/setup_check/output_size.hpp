// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Detects outputs in a wrong unit by their ratio to the rigid body's, if that explains half of the variance
/// left by friction. A mistake requires that two outputs or more agree (within a factor of 10) on a factor of
/// 50 too large or too small; for an arm of one joint, and for a wrench, a factor of 300. A warning if one
/// joint of several has a factor of 300. For currents with unknown torque constants: from 50 A/N·m, a single
/// joint from 200.
SetupFindings check_output_size(const ArmRecording& arm);

} // namespace dfdyn::tools
