// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/bounds.hpp"
#include "tools/training/likelihood/covariance.hpp"

#include <Eigen/Core>

#include <optional>
#include <utility>

namespace dfdyn::tools {

/// Estimated physics for one covariance; pi is in units of the given columns.
struct PhysicsFit {
    Eigen::VectorXd parameters;     ///< p: pi, generalised least squares (SP) or the posterior mean (P, SPK)
    Eigen::VectorXd prior_variance; ///< p: gamma^2 of each column; empty if pi has no prior
};

/// -2 log p(outputs) and its derivatives.
struct Evidence {
    double minus_two_log_likelihood = 0;
    /// Derivative with respect to each entry of C, treated as independent: count C^-1 - directions
    /// diag(weights) directions'.
    double count = 0;
    Eigen::MatrixXd directions;         ///< N x q
    Eigen::VectorXd weights;            ///< q
    Eigen::VectorXd parameter_gradient; ///< with respect to the given parameters
    Eigen::VectorXd output_variance;    ///< m: rho_k^2 (sigma_k^2 where C = I)
    PhysicsFit physics;                 ///< empty for NP
};

/// Likelihood of the outputs for a covariance C that is common to them, up to one factor per output. Used for
/// the exact kernel and for the random features.
class OutputLikelihood {
  public:
    OutputLikelihood() = default;
    OutputLikelihood(const OutputLikelihood&) = delete;
    OutputLikelihood& operator=(const OutputLikelihood&) = delete;
    virtual ~OutputLikelihood() = default;

    virtual Bounds bounds() const = 0; ///< of its own parameters, possibly none

    /// Returns the initial values of its own parameters if those of the input are `input`.
    virtual Eigen::VectorXd start(const Eigen::VectorXd& input) const = 0;

    /// `parameters`: the input's, then its own. Returns nothing if the physics cannot be solved.
    virtual std::optional<Evidence> evaluate(const Covariance& covariance,
                                             const Eigen::VectorXd& parameters) const = 0;
};

/// Zero-mean outputs y_k ~ N(0, rho_k^2 C), with each variance at its optimum rho_k^2 = y_k' C^-1 y_k / N: -2
/// log L = sum_k [N log(2 pi rho_k^2) + N] + m log det C. No parameters.
class ProfiledVarianceLikelihood final : public OutputLikelihood {
  public:
    /// N x m, means removed; no column may be zero.
    explicit ProfiledVarianceLikelihood(Eigen::MatrixXd outputs) : outputs_(std::move(outputs)) {}

    Bounds bounds() const override { return {Eigen::VectorXd(0), Eigen::VectorXd(0)}; }
    Eigen::VectorXd start(const Eigen::VectorXd& /*input*/) const override { return Eigen::VectorXd(0); }
    std::optional<Evidence> evaluate(const Covariance& covariance,
                                     const Eigen::VectorXd& parameters) const override;

  private:
    Eigen::MatrixXd outputs_;
};

} // namespace dfdyn::tools
