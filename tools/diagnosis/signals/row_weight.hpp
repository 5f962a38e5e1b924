// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"

namespace dfdyn::tools {

/// T x n, 0 to 1: how much a joint's torque tells at each row of what moves it. Nothing where the joint
/// stands (it travels less than friction takes to build up, for 0.3 s or more) and its output strays:
/// there friction is anything below the breakaway, and no function of the motion. A joint that hardly ever
/// moves is left alone, for what it says of the arm's weight is all it says; so is one whose output keeps to
/// the rigid body's torques (T x n) while it stands, for then it tells of their noise. Cost: T times the rows
/// of 0.3 s.
Eigen::MatrixXd joint_row_weight(const MeasuredMotion& measured, const Eigen::MatrixXd& torques);

/// T: less towards the ends of stretches, of which smoothing knows one side only, and slowly, for where a
/// noise of low frequencies begins at once, all frequencies are full of it. `joint_row_weight` has it in.
Eigen::VectorXd end_row_weight(const MeasuredMotion& measured);

} // namespace dfdyn::tools
