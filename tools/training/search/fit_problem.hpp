// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/search/fit.hpp"

#include <Eigen/Core>

#include <memory>
#include <optional>

namespace dfdyn::tools {

/// What is to be fitted: y = offset + mean + physics + f + e.
struct FitModel {
    bool kernel = true;                  ///< f; without it P
    Eigen::VectorXd offset;              ///< m
    std::optional<PhysicsPart> mean;     ///< fixed physics
    std::optional<ColumnChoice> columns; ///< physics that is fitted along, none with NP and SP2
    PhysicsPrior prior = PhysicsPrior::none;
};

/// All columns with the parameters that the caller gave, and the motion that training begins with.
PhysicsPart given_physics(const TrainingSetup& setup);

/// Outputs less what is fixed.
Eigen::MatrixXd remaining_outputs(const TrainingSetup& setup, const FitModel& model, const RowList& at);

/// The likelihoods of a model over the rows `at`, with an input of the given kind. Refers to `setup`.
class FitProblem {
  public:
    FitProblem(const TrainingSetup& setup, InputKind kind, const RowList& at, const FitModel& model);

    const InputMap& input() const { return *input_; }
    Bounds bounds() const;
    Eigen::VectorXd start(int index) const;

    /// Exact kernel, or none.
    const Likelihood& exact() const { return *exact_; }

    /// That of the model that will run: the random features that the options ask for, or no kernel.
    std::unique_ptr<Likelihood> running() const;

    /// The start that does as `structured` does at `theta`, a problem with input DFSR; this one has DFR.
    /// Where the physics shares rows with the input, it does so up to beta^M: the input's filters are the
    /// paper's, the physics' own are exact for ramps and parabolas (see difference_motion()).
    Eigen::VectorXd start_from(const FitProblem& structured, const Eigen::VectorXd& theta) const;

    /// P: r = l = 0.
    Hyperparameters split(const Eigen::VectorXd& theta) const;

  private:
    /// The parameters of the physics that do as DFSR's, beside the input at `input`.
    Eigen::VectorXd physics_from(const Hyperparameters& structured, const Eigen::VectorXd& input) const;

    Eigen::Index first_input() const { return kernel_ ? kernel_parameters : 0; }

    const TrainingSetup& setup_;
    bool kernel_;
    std::unique_ptr<InputMap> input_;
    std::unique_ptr<PhysicsColumns> physics_;
    std::unique_ptr<OutputLikelihood> outputs_;
    std::unique_ptr<Likelihood> exact_;
};

} // namespace dfdyn::tools
