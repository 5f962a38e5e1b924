// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/variance_components.hpp"

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Called after every point of a grid; may be empty.
using PointCallback = std::function<void()>;

constexpr int kernel_grid_points = 169;
constexpr int physics_grid_points = 25;

/// One point of a grid of hold-out cross validation (paper, Section IV-C).
struct HoldOutPoint {
    double length_scale = 0;   ///< of the kernel; 0 for P
    double noise_ratio = 0;    ///< of the kernel; 0 for P
    double prior_variance = 0; ///< gamma^2 of P in units of the given columns; 0 for the kernel
    /// Mean over the outputs of the held-out mean squared error divided by the output's variance there;
    /// infinite if the covariance could not be factored.
    double error = 0;
};

/// Trains on the first `training` samples and evaluates the others, at every point of a fixed grid: length
/// scale 0.5 … 32 in factors of the root of two, noise ratio 1e-6 … 1 in factors of the root of ten. `inputs`
/// N x D with unit standard deviation, `outputs` N x m with zero mean. One factorization per point serves all
/// outputs. 0 < training < N.
std::vector<HoldOutPoint> hold_out_kernel(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& outputs,
                                          Eigen::Index training, const PointCallback& done = {});

/// Trains and evaluates physics alone, for gamma^2 from 1e-6 to 1e6 in factors of the root of ten. The unit
/// of gamma^2 is the value at which prior and outputs have the same size. Outputs are weighted by their
/// least-squares residual. `columns` N x (m p) as in PhysicsColumns. Returns nothing if least squares has no
/// solution.
std::optional<std::vector<HoldOutPoint>> hold_out_physics(const Eigen::MatrixXd& columns,
                                                          const Eigen::MatrixXd& outputs,
                                                          Eigen::Index training,
                                                          const PointCallback& done = {});

/// Returns the point with the smallest error; the first of equal ones. `points` must not be empty.
const HoldOutPoint& best_point(const std::vector<HoldOutPoint>& points);

/// Returns whether a coordinate of `best` is at the edge of the grid: the true optimum may be outside.
bool at_edge(const HoldOutPoint& best, const std::vector<HoldOutPoint>& points);

} // namespace dfdyn::tools
