// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/variance_criterion.hpp"
#include "tools/training/search/fit.hpp"

#include <Eigen/Core>

#include <memory>
#include <optional>

namespace dfdyn::tools {

/// The model to fit: y = offset + mean + physics + f + e.
struct FitModel {
    bool kernel = true;                  ///< includes f; otherwise P
    Eigen::VectorXd offset;              ///< m
    std::optional<PhysicsPart> mean;     ///< fixed physics
    std::optional<ColumnChoice> columns; ///< fitted physics; none for NP and SP2
    PhysicsPrior prior = PhysicsPrior::none;
};

/// Returns all columns with the parameters given by the caller, and the initial motion.
PhysicsPart given_physics(const TrainingSetup& setup);

/// Returns the outputs minus the fixed parts.
Eigen::MatrixXd remaining_outputs(const TrainingSetup& setup, const FitModel& model, const RowList& at);

/// Likelihoods of a model over the rows `at`, with an input of the given kind. Refers to `setup`.
class FitProblem {
  public:
    FitProblem(const TrainingSetup& setup, InputKind kind, const RowList& at, const FitModel& model);

    const InputMap& input() const { return *input_; }
    Bounds bounds() const;
    Eigen::VectorXd start(int index) const;

    /// Likelihood with the exact kernel, or without a kernel.
    const Likelihood& exact() const { return *exact_; }

    /// Returns the likelihood of the estimator's model: with the random features of the options, or without a
    /// kernel.
    std::unique_ptr<Likelihood> running() const;

    /// Returns the start of this problem that is equivalent to `theta` of the problem `structured`, whose
    /// input is the one from which this input starts. If the physics uses rows of the input, the equivalence
    /// holds up to beta^M: the input's filters are the paper's, and the physics' own filters are exact for
    /// ramps and parabolas (see difference_motion()).
    Eigen::VectorXd start_from(const FitProblem& structured, const Eigen::VectorXd& theta) const;

    /// P: r = l = 0.
    Hyperparameters split(const Eigen::VectorXd& theta) const;

  private:
    /// Returns the physics' parameters that are equivalent to those of `structured` at `theta`, for the
    /// input's parameters `input`.
    Eigen::VectorXd physics_from(const FitProblem& structured, const Eigen::VectorXd& theta,
                                 const Eigen::VectorXd& input) const;

    Eigen::Index first_input() const { return kernel_ ? kernel_parameters : 0; }

    const TrainingSetup& setup_;
    InputKind kind_;
    bool kernel_;
    std::unique_ptr<InputMap> input_;
    std::unique_ptr<PhysicsColumns> physics_;
    std::unique_ptr<OutputLikelihood> outputs_;
    std::unique_ptr<Likelihood> exact_;
};

} // namespace dfdyn::tools
