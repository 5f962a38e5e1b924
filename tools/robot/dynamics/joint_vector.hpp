// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Limit of the chain's length. The simulation's vectors are on the stack, because its inner loop runs
/// millions of times.
inline constexpr int largest_simulated_chain = 12;

/// One number per joint, base to tip.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, largest_simulated_chain, 1>;

/// Joints × joints.
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  largest_simulated_chain, largest_simulated_chain>;

/// Jacobian of a point: 3 × joints.
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, largest_simulated_chain>;

/// Force (N), then torque (N·m).
using Wrench = Eigen::Matrix<double, 6, 1>;

/// Linear map from wrench to wrench.
using WrenchMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

} // namespace dfdyn::tools
