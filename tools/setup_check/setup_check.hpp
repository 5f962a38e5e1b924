// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <vector>

namespace dfdyn::tools {

/// What is known of a recording's set-up.
struct SetupQuestion {
    OutputKind outputs = OutputKind::joint_torque;
    const Robot* robot = nullptr;              ///< null: only what the recording alone shows
    std::vector<double> torque_constants = {}; ///< N·m/A per joint, > 0, for currents; empty: unknown
};

/// Finds classic mistakes behind a recording, before any work starts: units, clock, wrapped angles, dead
/// channels, signs, and with a robot the order of columns and gravity. Checks by the robot are left out where
/// its number of joints is not the recording's, or the torque constants cannot be: other messages name that.
/// Docs: docs/guide/setup-check.md. Cost: half a second for an arm of six joints.
SetupFindings check_setup(const Recording& recording, const SetupQuestion& question);

} // namespace dfdyn::tools
