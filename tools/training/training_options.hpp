// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/structure.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/physics/regressor.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>

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

/// Velocity and acceleration of the physics for inputs of positions. With STD they are always the
/// recording's.
enum class PhysicsMotion {
    free,  ///< rows of its own, free but for their response to ramps and parabolas; see free_motion()
    poles, ///< filters like those of DFSR, with separate poles; see difference_motion()
    /// As in the paper, derived from the input. DFSR: its two filters in physical units; DFR: its rows 2 and
    /// 3, of length 1, with learned factors, which need not be physical; DF, DFW: a polynomial of degree 2.
    of_input,
};

/// The physics of P, SP, SP2 and SPK.
struct PhysicsOptions {
    const Regressor* regressor = nullptr; ///< of the recording's joints and outputs; must outlive training
    PhysicsMotion motion = PhysicsMotion::free;
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
    double forgetting_factor = 1;    ///< of the learner, in [least_forgetting_factor(), 1]
    double position_noise_bound = 0; ///< STD only, copied into the model
    /// CV: share of the likelihood rows for training; the others are held out; in (0, 1)
    double training_share = 0.7;
};

/// Return the value with this name (`scaled`, `unit` or `diagonal`; ML or CV). Throw InputError for any other
/// name.
PriorForm parse_prior_form(const std::string& name);
HyperMethod parse_hyper_method(const std::string& name);

/// Returns the largest number of lags of a window that is given in seconds. For inputs of derivatives and for
/// cross validation it is that of any window, because their lags must be one sample apart.
int most_window_lags(const TrainingOptions& options);

/// Returns the forgetting factor per sample with which a sample weighs 1/e of a new one after `memory_s`:
/// exp(-period_s / memory_s). Both > 0.
double forgetting_factor_of(double memory_s, double period_s);

/// Returns the inverse of forgetting_factor_of(): the memory (s); 0 for one that is unlimited, at a factor
/// of 1. 0 < forgetting_factor <= 1, period_s > 0.
double memory_of(double forgetting_factor, double period_s);

/// Returns the forgetting factor as a model has it, in single precision. 1 above 1 - 3e-8, a memory of 3.4e7
/// samples.
double stored_forgetting_factor(double forgetting_factor);

/// Returns the smallest forgetting factor: 1 - 1/(2d), a memory of one sample per column of the features.
/// Without features it is 0.5, because the number of columns is known only after the choice of columns.
double least_forgetting_factor(const TrainingOptions& options);

/// Throws InputError, `training options: expected …, found …`, unless all options are in range and consistent
/// with each other and with `data`.
void check_options(const TrainingOptions& options, const TrainingData& data);

} // namespace dfdyn::tools
