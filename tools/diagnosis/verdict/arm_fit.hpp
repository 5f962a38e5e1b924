// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Least squares of all joints at once, with links that may differ from the robot's file.
struct ArmFit {
    std::vector<MovingFit> joints; ///< n: values and covariances of the terms of plain least squares
    Eigen::MatrixXd rest;          ///< T x n: residual of the measured torques
};

/// Fits joint torques (T x n) in the rows in which the joints move. The unknowns are the terms of plain least
/// squares at each joint, with a prior for the rigid body's gain only, and errors of each link with a prior:
/// 10 % of its mass, 3 cm of its centre of mass, 30 % of its moments of inertia. In plain least squares,
/// friction and offset absorb such errors, differently in each motion. `plain`: plain least squares of each
/// joint. `gains_known`: a joint's gain is 1 ± 0.03, unless the data contradict it by three deviations. Cost:
/// O((10 n)² T n).
ArmFit fit_arm(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured, std::vector<MovingFit> plain,
               bool gains_known);

} // namespace dfdyn::tools
