// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/structure.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/physics/physics_start.hpp"
#include "tools/training/physics/regressor.hpp"
#include "tools/training/search/hold_out.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Estimation methods of the hyperparameters (paper, Section IV-C).
enum class HyperMethod {
    ML, ///< marginal likelihood
    CV, ///< hold-out cross validation over a grid; NP, P and SP2 with inputs STD, DF and DFSR
};

/// Prior of pi for P and SPK.
enum class PriorForm {
    scaled,   ///< equal gamma^2 for columns that have equal size over the recording
    unit,     ///< as in the paper: gamma^2 I for the physical parameters
    diagonal, ///< D estimated, gamma = 1
};

/// The physics of P, SP, SP2 and SPK.
struct PhysicsOptions {
    const Regressor* regressor = nullptr; ///< of the recording's joints and outputs; must outlive training
    /// Motion input of the regressor. False, as in the paper: derived from the input. STD: the recording's
    /// derivatives; DFSR: its two filters in physical units (see difference_motion()); DFR: its rows 2 and 3,
    /// of length 1, with additional factors; DF, DFW: a polynomial of degree 2 through the window. True:
    /// filters like those of DFSR, with separate poles.
    bool own_motion = false;
    PriorForm prior = PriorForm::scaled;
    double column_threshold = 1e-3; ///< of select_columns(), in (0, 1)
    /// P: largest plausible magnitude of each parameter of the regressor, > 0, in the parameter's own unit;
    /// empty: unknown. Used to choose columns (see select_columns()) and to bound the standard deviation of
    /// the prior.
    Eigen::VectorXd parameter_size;
    /// P each: the robot's own parameters and their standard deviations (> 0). Empty: unknown. With
    /// `TrainingOptions::shrinkage`, the initial state of P, SP, SP2 and SPK is the solution with this prior
    /// (see robot_prior()) instead of gamma^2.
    Eigen::VectorXd nominal, nominal_deviation;
    std::optional<Eigen::VectorXd> given; ///< SP2: all physical parameters, instead of least squares
};

/// Options of the training, with their defaults.
struct TrainingOptions {
    const Structure* model = &structures::NP; ///< not null
    HyperMethod hyper = HyperMethod::ML;
    PhysicsOptions physics; ///< used unless the model is NP
    InputKind input = InputKind::DFR;
    int lags = 10; ///< M >= 1 (DFSR and filters of the physics: >= 2); STD: the longest window minus one
    int every = 1; ///< spacing of the lags in samples, see LagSpacing; > 1: not STD, not CV
    int rows_per_joint = 3; ///< k of DFR, 1 … M+1; fixed for the other inputs
    /// STD: gains of velocity and acceleration in addition to the length scale, by ML. False, as in the
    /// paper: one length scale for inputs with unit standard deviation.
    bool relevance = true;
    bool centred = true; ///< NP: outputs minus their mean; false, as in the paper: a prior with zero mean
    /// True: physics starts near the robot's own parameters, if PhysicsOptions contains them. Away from the
    /// data, predictions return to the mean (NP), the physics or zero (P), and standard deviations grow to
    /// the range of the outputs. False, as in the paper: neither.
    bool shrinkage = true;
    int feature_count = 250; ///< d >= 1; P has none
    bool orthogonal = true;  ///< orthogonal random features
    /// largest number of samples in the exact kernel; >= 20; the time grows with its cube
    int likelihood_rows = 1000;
    int starts = 6;                  ///< local searches, >= 1
    int evaluations_per_start = 200; ///< maximum, >= 1
    /// maximum, with the likelihood of the estimator's model over all rows; 0: no refinement
    int refinement_evaluations = 40;
    int threads = 2;                 ///< >= 1; does not change the result
    std::uint64_t seed = 1;          ///< of the starts and of omega
    double forgetting_factor = 1;    ///< of the learner, in [1 - 1/(2d), 1]
    double position_noise_bound = 0; ///< STD only, copied into the model
    /// CV: share of the likelihood rows for training; the others are held out; in (0, 1)
    double training_share = 0.7;
};

/// Progress of the training: reported after every evaluation of the likelihood or every point of the grid,
/// and once when the batch solution begins.
struct TrainingProgress {
    bool searching = true; ///< false: the hyperparameters are determined, and the initial state is computed
    int evaluations = 0;   ///< so far, over all starts and the refinement
    int evaluations_most = 0; ///< if no search ends early
    /// Present only in the call that reports the end of a start.
    struct End {
        int start = 0;
        std::optional<double> log_likelihood; ///< empty: the start failed, no point had a finite likelihood
    };
    std::optional<End> end;
};

/// May be empty. Called from the worker threads, one call at a time.
using ProgressCallback = std::function<void(const TrainingProgress&)>;

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
