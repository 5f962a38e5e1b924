// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/search/variance_components.hpp"

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Called after every point of a grid; may be empty.
using PointCallback = std::function<void()>;

constexpr int kernel_grid_points = 169;
constexpr int physics_grid_points = 25;

/// One point of a grid of hold-out cross validation (eq:CVcost).
struct HoldOutPoint {
    double length_scale = 0;   ///< of the kernel; 0 for P
    double noise_ratio = 0;    ///< of the kernel; 0 for P
    double prior_variance = 0; ///< gamma^2 of P in units of the columns handed in; 0 for the kernel
    /// Mean over the outputs of the mean squared error on the held-out samples over the output's variance
    /// there; infinite where the covariance could not be factored.
    double error = 0;
};

/// Trains on the first `training` samples, measures on the others, at every point of a fixed grid: length
/// scale 0.5 … 32 in factors of the root of two, noise ratio 1e-6 … 1 in factors of the root of ten. `inputs`
/// N x D of unit deviation, `outputs` N x m without mean. One factorisation per point serves all outputs. 0 <
/// training < N.
std::vector<HoldOutPoint> hold_out_kernel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs,
                                          Eigen::Index training, const PointCallback& done = {});

/// The same for physics alone: gamma^2 from 1e-6 to 1e6, in factors of the root of ten, of the value at which
/// prior and outputs have the same size. Outputs are weighted by what least squares leaves of them. `columns`
/// N x (m p) as of PhysicsColumns. Nothing where least squares has no solution.
std::optional<std::vector<HoldOutPoint>> hold_out_physics(const Eigen::MatrixXd& columns,
                                                          const Eigen::MatrixXd& outputs,
                                                          Eigen::Index training,
                                                          const PointCallback& done = {});

/// The point with the smallest error, the first of equals. Not empty.
const HoldOutPoint& best_point(const std::vector<HoldOutPoint>& points);

/// Whether one of the coordinates of `best` is the grid's least or largest: the true optimum may lie outside.
bool at_edge(const HoldOutPoint& best, const std::vector<HoldOutPoint>& points);

} // namespace dfdyn::tools
