// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/output_likelihood.hpp"
#include "tools/training/likelihood/variance_components.hpp"
#include "tools/training/physics/physics_columns.hpp"

#include <utility>

namespace dfdyn::tools {

/// Outputs with physics: y_k = Psi_k pi + e_k, e_k ~ N(0, rho_k^2 C). Without a prior on pi it is model SP
/// (with C = I the least squares of P and SP2); with a prior it is SPK (with C = I model P), where gamma^2
/// Psi Psi' is added by the matrix inversion lemma (paper, Section III-D). All rho_k^2, pi and gamma^2 have
/// their most likely values for every C, found from the statistics Psi_k' C^-1 Psi_k. An exception is a
/// diagonal prior: its logarithms are parameters, after those of the physics. Refers to `physics`, which must
/// outlive it.
class PhysicsLikelihood final : public OutputLikelihood {
  public:
    /// `outputs` N x m, not centred, because the physics explains the mean.
    PhysicsLikelihood(Eigen::MatrixXd outputs, const PhysicsColumns& physics, PhysicsPrior prior)
        : outputs_(std::move(outputs)), physics_(physics), prior_(prior) {}

    Bounds bounds() const override;
    Eigen::VectorXd start(const Eigen::VectorXd& input) const override;

    /// One solve with m (p + 1) right-hand sides, O(N m p^2) and a few O(m p^3).
    std::optional<Evidence> evaluate(const Covariance& covariance,
                                     const Eigen::VectorXd& parameters) const override;

  private:
    /// Number of parameters that are logarithms of the prior's variances.
    Eigen::Index prior_parameters() const {
        return prior_ == PhysicsPrior::diagonal ? physics_.columns() : 0;
    }

    Eigen::MatrixXd outputs_;
    const PhysicsColumns& physics_;
    PhysicsPrior prior_;
};

/// Returns the statistics of outputs (N x m) and columns Psi (N x (m p), see PhysicsColumns), from the
/// products of both with C^-1.
LinearStatistics linear_statistics(const Eigen::MatrixXd& outputs, const Eigen::MatrixXd& columns,
                                   const Eigen::MatrixXd& solved_outputs,
                                   const Eigen::MatrixXd& solved_columns);

} // namespace dfdyn::tools
