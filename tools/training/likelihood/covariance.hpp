// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Covariance C (N x N, positive definite) of the exact kernel, of random features, or of white noise. It is
/// common to all outputs up to a factor.
class Covariance {
  public:
    virtual ~Covariance() = default;

    virtual double log_determinant() const = 0;

    /// Returns C^-1 B for B with N rows.
    virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const = 0;

  protected:
    Covariance() = default;
    Covariance(const Covariance&) = default;
    Covariance(Covariance&&) = default;
    Covariance& operator=(const Covariance&) = default;
    Covariance& operator=(Covariance&&) = default;
};

/// C = I: white noise only.
class WhiteCovariance final : public Covariance {
  public:
    double log_determinant() const override { return 0; }
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const override { return right_hand_sides; }
};

} // namespace dfdyn::tools
