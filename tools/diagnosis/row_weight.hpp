// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/measured_motion.hpp"

namespace dfdyn::tools {

/// T x n, 0 to 1: how much a joint's torque tells at each row of what moves it. Nothing where the joint
/// stands (it travels less than friction takes to build up, for half a second or more): there friction is
/// anything below the breakaway, and no function of the motion. A joint that hardly ever moves is left alone,
/// for what it says of the arm's weight is all it says. Little at the ends of stretches, too, where smoothing
/// knows one side only. Cost: T times the rows of half a second.
Eigen::MatrixXd joint_row_weight(const MeasuredMotion& measured);

/// T: what of `joint_row_weight` is for the stretches' ends.
Eigen::VectorXd end_row_weight(const MeasuredMotion& measured);

} // namespace dfdyn::tools
