// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"
#include "tools/robot/robot.hpp"

namespace dfdyn::tools {

/// Returns the weight (T x n, 0 to 1) of each row of a joint's torque in the regression. The weight is 0
/// during standstill (less travel than 3 mrad, or 0.3 mm at a prismatic joint, in 0.3 s) if the output
/// deviates from the rigid-body torque there. Static friction then takes any value up to the breakaway torque
/// and is not a function of the motion.
///
/// All rows keep their weight in two cases:
/// - the joint moves in less than a tenth of the rows: its standstills are the only information on the arm's
///   weight;
/// - its output follows the rigid-body torque (`torques`, T x n) during standstill.
///
/// The weights include those of `end_row_weight`. Cost: T times the rows of 0.3 s.
Eigen::MatrixXd joint_row_weight(const Robot& robot, const MeasuredMotion& measured,
                                 const Eigen::MatrixXd& torques);

/// Returns weights (T) that taper towards the ends of each segment. Smoothing is one-sided there, and an
/// abrupt start would leak low-frequency noise into all bins. `joint_row_weight` includes this taper.
Eigen::VectorXd end_row_weight(const MeasuredMotion& measured);

} // namespace dfdyn::tools
