// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
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

/// The model classes of the paper (section "Model Classes").
enum class ModelClass { NP, P, SP, SP2, SPK };

/// How hyperparameters are found (section "Hyperparameter vector estimation").
enum class HyperMethod {
    ML, ///< marginal likelihood
    CV, ///< hold-out cross validation over a grid; NP, P and SP2 with inputs STD, DF and DFSR
};

/// What is known of pi before the data, for P and SPK.
enum class PriorForm {
    scaled,   ///< gamma^2 the same for columns that have the same size over the recording
    unit,     ///< the paper's: gamma^2 I for the physical parameters
    diagonal, ///< D estimated, gamma = 1
};

/// The physics of P, SP, SP2 and SPK.
struct PhysicsOptions {
    const Regressor* regressor = nullptr; ///< of the recording's joints and outputs; must outlive training
    /// Which motion the regressor sees. False, the paper's: that of the input. STD: the recording's; DFSR:
    /// its two filters in physical units (see difference_motion()); DFR: its rows 2 and 3, of length 1, times
    /// factors of their own; DF, DFW: a polynomial of degree 2 through the window. True: filters like
    /// DFSR's, with poles of their own.
    bool own_motion = false;
    PriorForm prior = PriorForm::scaled;
    double column_threshold = 1e-3; ///< of select_columns(), in (0, 1)
    /// P: magnitude that each parameter of the regressor can have in a machine, > 0, in the parameter's own
    /// unit; empty: unknown. Chooses columns (see select_columns()) and bounds the deviation of the prior.
    Eigen::VectorXd parameter_size;
    /// P each: what the robot's own parameters are, and how far they may be from the true ones (> 0). Empty:
    /// unknown. With `TrainingOptions::shrinkage`, the start of P, SP, SP2 and SPK is the solution under
    /// this prior (see robot_prior()) in place of gamma^2.
    Eigen::VectorXd nominal, nominal_deviation;
    std::optional<Eigen::VectorXd> given; ///< SP2: all physical parameters, in place of least squares
};

/// How to train; the values here are the defaults.
struct TrainingOptions {
    ModelClass model = ModelClass::NP;
    HyperMethod hyper = HyperMethod::ML;
    PhysicsOptions physics; ///< read unless the model is NP
    InputKind input = InputKind::DFR;
    int lags = 10; ///< M >= 1 (DFSR and filters of the physics: >= 2); STD: the longest window minus one
    int every = 1; ///< lags are so many samples apart, see LagSpacing; > 1: not STD, not CV
    int rows_per_joint = 3; ///< k of DFR, 1 … M+1; the other inputs have their own
    /// STD: gains of velocity and acceleration beside the length scale, by ML. False, the paper's: one width
    /// for inputs of unit deviation.
    bool relevance = true;
    bool centred = true; ///< NP: outputs less their mean; false, the paper's: a prior of mean zero
    /// Physics starts near the robot's own parameters, where PhysicsOptions knows them. Away from the data,
    /// predictions go back to the mean (NP), the physics or zero (P), and standard deviations grow to what
    /// the outputs span. False: none of it, as in the paper.
    bool shrinkage = true;
    int feature_count = 250;         ///< d >= 1; P has none
    bool orthogonal = true;          ///< orthogonal random features
    int likelihood_rows = 1000;      ///< samples in the exact kernel, at most; >= 20; time goes with the cube
    int starts = 6;                  ///< local searches, >= 1
    int evaluations_per_start = 200; ///< at most, >= 1
    int refinement_evaluations = 40; ///< at most, by the model that will run over all rows; 0: no refinement
    int threads = 2;                 ///< >= 1; does not change the result
    std::uint64_t seed = 1;          ///< of the starts and of omega
    double forgetting_factor = 1;    ///< of the learner, in [1 - 1/(2d), 1]
    double position_noise_bound = 0; ///< STD only, copied into the model
    double training_share = 0.7;     ///< CV: of the likelihood rows, the others are held out; in (0, 1)
};

/// How far training is: after every evaluation of the likelihood, or every point of the grid, and once when
/// the batch solution begins.
struct TrainingProgress {
    bool searching = true;    ///< false: the hyperparameters are found, the start of learning is computed
    int evaluations = 0;      ///< so far, of all starts and the refinement
    int evaluations_most = 0; ///< if none ends early
    /// Only in the call that reports a start's end.
    struct End {
        int start = 0;
        std::optional<double> log_likelihood; ///< nothing: the start failed, no point had a finite likelihood
    };
    std::optional<End> end;
};

/// May be empty. Called from the working threads, one call at a time.
using ProgressCallback = std::function<void(const TrainingProgress&)>;

/// The physical part of a trained model: y_k = offset_k + noise_std_k (phi' w_k + psi~_k' pi + e), psi~_k =
/// psi_k column_scale / noise_std_k, pi ~ N(0, prior_variance I); the physical parameters are column_scale
/// pi.
struct TrainedPhysics {
    /// 3 x (M+1): position, velocity and acceleration from a joint's last positions, newest first; in 1, 1/s,
    /// 1/s^2. Empty: the recording's derivatives (STD).
    Eigen::MatrixXd motion_rows;
    std::vector<Eigen::Index> columns; ///< p chosen columns of the regressor, ascending
    /// p: prior "scaled": 1 / (root mean square of the column over the likelihood rows, each output's rows
    /// over the output's deviation), times the geometric mean of noise_std over that of the outputs'
    /// deviations, so that psi~ is of order 1; "unit": 1; "diagonal": the square roots of D. At most
    /// PhysicsOptions::parameter_size / gamma, so that no parameter's prior deviation exceeds what a machine
    /// can have.
    Eigen::VectorXd column_scale;
    double prior_variance = 0; ///< gamma^2 in these units; 0 for SP and SP2, whose pi is fixed
    PhysicsStart start;
};

struct TrainingResult {
    /// Structure, hyperparameters, outputs and start of the nonparametric part. P: no features, no weights.
    /// SPK: `start.weights` holds the weights at pi = 0 (see PhysicsStart::coupling).
    TrainedModel model;
    std::optional<TrainedPhysics> physics; ///< nothing for NP
    std::vector<HoldOutPoint> hold_out;    ///< CV: the errors over the grid
};

/// Trains a model. ML: hyperparameters by marginal likelihood of the exact kernel on strided rows in motion,
/// refined by that of the random features on all usable rows (see FeatureLikelihood); DFR begins with the
/// best fit of DFSR, then with polynomial differentiators and filters. CV: over a grid, training on the first
/// of these rows and measured on the last. Then the batch solution over all usable rows as the start.
///
/// NP's outputs are centred at their mean over the rows in motion unless `centred` is false; with physics the
/// offset is 0, since gravity and an offset among the effects explain the mean. SP: pi by generalised least
/// squares under the best kernel; SP2: least squares of the physics alone, its motion rows included, each
/// output weighted by what remains of it, then NP on the residual.
///
/// A plausible position is at most ten times the largest magnitude seen (at least 2 pi), an output ten times
/// its largest. The same data, options and program give the same model bit for bit, whatever the number of
/// threads. `training.recordings` and `training.rows` are left to the caller. `training.all_starts` holds the
/// starts that did not fail, in their order. Throws InputError for options out of range, data as
/// check_training_data() says, fewer than 20 usable rows in motion, a constant output, physics that the
/// recording does not excite, or when every start fails. Cost: starts * evaluations * O(likelihood_rows^3),
/// then O(T (2d)^2 + (2d)^3).
TrainingResult train(const TrainingData& data, const TrainingOptions& options,
                     const ProgressCallback& progress = {});

} // namespace dfdyn::tools
