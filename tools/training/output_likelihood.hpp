// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/covariance_factor.hpp"
#include "tools/training/input_rows.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// -2 log p(outputs) and its derivatives.
struct Evidence {
    double minus_two_log_likelihood = 0;
    /// N x N, symmetric: derivative with respect to each entry of the covariance C as if the entries were
    /// independent.
    Eigen::MatrixXd covariance_gradient;
    Eigen::VectorXd parameter_gradient; ///< with respect to the likelihood's own parameters
    Eigen::VectorXd output_variance;    ///< m: rho_k^2
};

/// How likely the outputs are, given the covariance C = K + r I that they share up to a factor. A linear part
/// (a profiled mean, or gamma^2 psi psi' added by the matrix inversion lemma) is another class with
/// parameters of its own; kernel and inputs stay.
class OutputLikelihood {
  public:
    OutputLikelihood() = default;
    OutputLikelihood(const OutputLikelihood&) = delete;
    OutputLikelihood& operator=(const OutputLikelihood&) = delete;
    virtual ~OutputLikelihood() = default;

    virtual Bounds bounds() const = 0; ///< of its own parameters, possibly none
    virtual Evidence evaluate(const CovarianceFactor& factor, const Eigen::VectorXd& parameters) const = 0;
};

/// Zero-mean outputs y_k ~ N(0, rho_k^2 C), each variance at its maximum rho_k^2 = y_k' C^-1 y_k / N:
/// -2 log L = sum_k [N log(2 pi rho_k^2) + N] + m log det C. No parameters. O(N^3).
class ProfiledVarianceLikelihood final : public OutputLikelihood {
  public:
    /// N x m, means removed; no column may be zero.
    explicit ProfiledVarianceLikelihood(Eigen::MatrixXd outputs) : outputs_(std::move(outputs)) {}

    Bounds bounds() const override { return {Eigen::VectorXd(0), Eigen::VectorXd(0)}; }
    Evidence evaluate(const CovarianceFactor& factor, const Eigen::VectorXd& parameters) const override;

  private:
    Eigen::MatrixXd outputs_;
};

} // namespace dfdyn::tools
