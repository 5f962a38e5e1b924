// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/covariance.hpp"

#include <Eigen/Cholesky>

#include <optional>

namespace dfdyn::tools {

/// C = Phi Phi' + r I by the matrix inversion lemma. Refers to Phi, which must outlive it.
class RidgeCovariance final : public Covariance {
  public:
    /// Returns nothing if Phi' Phi + r I is not positive definite in double precision. O(N (2d)^2 + (2d)^3).
    static std::optional<RidgeCovariance> of(const Eigen::MatrixXd& phi, double noise_ratio);

    double log_determinant() const override;

    /// O(N 2d) per column of B.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const override;

    /// Returns (Phi' Phi + r I)^-1, 2d x 2d; C^-1 Phi = Phi times it.
    Eigen::MatrixXd inverse_information() const;

    /// Returns r tr C^-1, from inverse_information().
    double scaled_trace(const Eigen::MatrixXd& inverse_information) const;

  private:
    RidgeCovariance(const Eigen::MatrixXd& phi, double noise_ratio, Eigen::LLT<Eigen::MatrixXd> factor)
        : phi_(&phi), noise_ratio_(noise_ratio), factor_(std::move(factor)) {}

    const Eigen::MatrixXd* phi_;
    double noise_ratio_;
    Eigen::LLT<Eigen::MatrixXd> factor_;
};

} // namespace dfdyn::tools
