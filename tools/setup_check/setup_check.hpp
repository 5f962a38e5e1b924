// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"
#include "tools/setup_check/setup_finding.hpp"

#include <vector>

namespace dfdyn::tools {

/// Minimum time step between rows (s). Shorter steps indicate a wrong unit of time.
inline constexpr double shortest_step_s = 2e-5;

/// Known facts of a recording's set-up.
struct SetupQuestion {
    OutputKind outputs = OutputKind::joint_torque;
    const Robot* robot = nullptr;              ///< null: checks of the recording only
    std::vector<double> torque_constants = {}; ///< N·m/A per joint, > 0, for currents; empty: unknown
};

/// Detects common mistakes in a recording before any work starts: units, clock, wrapped angles, dead
/// channels, signs, and, with a robot, the order of columns and gravity. Checks with the robot are skipped if
/// its number of joints differs from the recording's, or if the torque constants are invalid; other messages
/// report this. Docs: docs/guide/setup-check.md. Cost: half a second for an arm of six joints.
SetupFindings check_setup(const Recording& recording, const SetupQuestion& question);

} // namespace dfdyn::tools
