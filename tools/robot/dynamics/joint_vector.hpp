// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// The simulation's inner loop runs millions of times: its vectors live on the stack, which bounds the chain.
inline constexpr int largest_simulated_chain = 12;

/// One number per joint, base to tip.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, largest_simulated_chain, 1>;

/// Joints × joints.
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                  largest_simulated_chain, largest_simulated_chain>;

/// Of a point: 3 × joints.
using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, largest_simulated_chain>;

/// Force (N), then torque (N·m).
using Wrench = Eigen::Matrix<double, 6, 1>;

/// From wrench to wrench.
using WrenchMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

} // namespace dfdyn::tools
