// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/structure.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"
#include "tools/training/physics/physics_columns.hpp"

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Initial estimate of pi, in units of column_scale and noise_std: psi~_k = psi_k column_scale / noise_std_k.
struct PhysicsStart {
    Eigen::VectorXd parameters;     ///< p: pi^
    std::vector<double> unit_upper; ///< of P_pi = U D U', by columns as in StartModel; empty if pi is fixed
    std::vector<double> diagonal;   ///< p; empty if pi is fixed
    /// SPK: G_k = Lambda_phi^-1 sum_t lambda^(N-t) phi psi~_k', m times 2d x p. The weights of output k given
    /// pi are A_k - G_k pi, and their covariance is Lambda_phi^-1 + G_k P_pi G_k'.
    std::vector<Eigen::MatrixXd> coupling;
};

/// Initial states of NP's part and of the physics.
struct InitialState {
    StartModel kernel; ///< P: empty. SPK: `weights` holds A_k. Otherwise those of the residual.
    PhysicsStart physics;
};

/// Data for the initial state of a model with physics.
struct PhysicsProblem {
    const TrainedModel& model; ///< forgetting factor, input, features, outputs; P: no features
    const TrainingData& data;
    const RowList& rows;
    const Eigen::MatrixXd& columns; ///< psi column_scale at `rows`, N x (m p) as in PhysicsColumns
};

/// A Gaussian prior of pi, in the units of PhysicsStart::parameters.
struct ParameterPrior {
    Eigen::VectorXd mean;        ///< p
    Eigen::MatrixXd information; ///< p x p, the inverse of the covariance

    /// The paper's prior: N(0, prior_variance I).
    static ParameterPrior independent(Eigen::Index p, double prior_variance);
};

/// Returns the regularised least-squares solution (paper, Section IV-B) of P: pi^ and its covariance under
/// the prior. The prior has the same weight under forgetting as in batch_start(). O(N m p^2 + p^3). Throws
/// InputError if the information matrix cannot be factored.
InitialState parametric_start(const PhysicsProblem& problem, const ParameterPrior& prior);

/// SP, SP2: returns NP's initial state for the residual of the outputs with fixed `parameters`.
InitialState residual_start(const PhysicsProblem& problem, const Eigen::VectorXd& parameters);

/// Returns the initial state of SPK in block-arrow form: the factor of Lambda_phi, common to all outputs, and
/// the Schur complement of pi. Equal to the joint solution for all unknowns. O(N (2d)^2 + N m 2d p + (2d)^3).
InitialState joint_initial_state(const PhysicsProblem& problem, const ParameterPrior& prior);

/// Returns the initial state of a structure with physics. For a learned pi this is joint_initial_state() if
/// physics and features are fitted jointly, otherwise parametric_start(). For a fixed pi this is
/// residual_start() with `fixed` (p, in the units of PhysicsProblem's columns); without `fixed`, with the
/// estimate under `prior`.
InitialState initial_state_of(const Structure& structure, const PhysicsProblem& problem,
                              const ParameterPrior& prior, const std::optional<Eigen::VectorXd>& fixed);

} // namespace dfdyn::tools
