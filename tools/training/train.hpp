// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/training_data.hpp"
#include "tools/training/search/hold_out.hpp"
#include "tools/training/start/initial_state.hpp"
#include "tools/training/training_options.hpp"
#include "tools/training/training_progress.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// The physical part of a trained model: y_k = offset_k + noise_std_k (phi' w_k + psi~_k' pi + e), psi~_k =
/// psi_k column_scale / noise_std_k, pi ~ N(0, prior_variance I); the physical parameters are column_scale
/// pi.
struct TrainedPhysics {
    /// 3 x (M+1): position, velocity and acceleration from a joint's last positions, newest first; in 1, 1/s,
    /// 1/s^2. Empty: the recording's derivatives (STD).
    Eigen::MatrixXd motion_rows;
    std::vector<Eigen::Index> columns; ///< p chosen columns of the regressor, ascending
    /// p, by the form of the prior. "unit": 1. "diagonal": the square roots of D. "scaled": g / r, so that
    /// psi~ has order 1. With the standard deviation s_k of output k, r is the root mean square of the column
    /// over the likelihood rows, those of output k divided by s_k, and g the geometric mean of noise_std_k /
    /// s_k. At most PhysicsOptions::parameter_size / gamma, so that no parameter's prior standard deviation
    /// exceeds its plausible size.
    Eigen::VectorXd column_scale;
    double prior_variance = 0; ///< gamma^2 in these units; 0 for SP and SP2, whose pi is fixed
    PhysicsStart start;
};

struct TrainingResult {
    /// Structure, hyperparameters, outputs and initial state of the nonparametric part. P: no features, no
    /// weights. SPK: `start.weights` contains the weights at pi = 0 (see PhysicsStart::coupling).
    TrainedModel model;
    std::optional<TrainedPhysics> physics; ///< empty for NP
    std::vector<HoldOutPoint> hold_out;    ///< CV: the errors over the grid
    /// Joints, from 0, whose motion is too small to learn from; see LagSpread::deviation().
    std::vector<std::size_t> held_joints = {};
};

/// Trains a model. ML: maximizes the marginal likelihood of the exact kernel on strided rows in motion. Then
/// it refines the hyperparameters with the likelihood of the features on all usable rows (FeatureLikelihood).
/// DFR starts from the best fit of DFSR, then from polynomial differentiators and filters. CV: searches a
/// grid, with training on the first of these rows and evaluation on the last. Finally, the batch solution
/// over all usable rows becomes the initial state.
///
/// NP's outputs are centred at their mean over the rows in motion unless `centred` is false. With physics the
/// offset is 0, since gravity and an offset among the effects explain the mean. SP: pi by generalised least
/// squares with the best kernel. SP2: least squares of the physics alone, including its motion rows, with
/// each output weighted by its residual; then NP on the residual.
///
/// A plausible position is at most ten times the largest recorded magnitude (at least 2 pi), and a plausible
/// output ten times its largest. Equal data, options and program give the same model bit for bit, for any
/// number of threads. The caller sets `training.recordings` and `training.rows`. `training.all_starts`
/// contains the starts that did not fail, in order.
///
/// Throws InputError for options out of range and for data rejected by check_training_data(); for fewer than
/// 20 usable rows in motion and for a constant output; for physics that the recording does not excite; and if
/// every start fails. Cost: starts * evaluations * O(likelihood_rows^3), then O(T (2d)^2 + (2d)^3).
TrainingResult train(const TrainingData& data, const TrainingOptions& options,
                     const ProgressCallback& progress = {});

} // namespace dfdyn::tools
