// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/setup_check/rigid_comparison.hpp"
#include "tools/setup_check/setup_finding.hpp"

namespace dfdyn::tools {

/// Positions beyond the joints' limits (2 pi without limits): another unit when more than five times, else
/// another zero or robot.
SetupFindings check_position_limits(const Robot& robot, const Recording& recording);

/// Joints that move less than 0.05 rad (m): no effect of theirs can be named. `position`: T x n.
SetupFindings check_standstill(const Eigen::MatrixXd& position);

/// Mistakes that a comparison with the rigid body shows, each only where the other reading fits far better:
/// - outputs 30 times too large or too small with the same course; currents of unknown gain: more than
///   50 A/N·m at the joint (`gains_known` false);
/// - outputs or positions of two joints exchanged;
/// - outputs of the wrong sign, gravity of the wrong direction;
/// - outputs that have next to nothing in common with the robot's model: unanswerable.
/// Cost: n^2 / 2 times 2,000 rigid-body regressors.
SetupFindings check_against_robot(const RigidComparison& comparison, bool gains_known);

} // namespace dfdyn::tools
