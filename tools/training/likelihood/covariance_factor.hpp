// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/covariance.hpp"

#include <Eigen/Core>

#include <optional>

namespace dfdyn::tools {

/// Cholesky factor C = L L' of a covariance matrix.
class CovarianceFactor final : public Covariance {
  public:
    /// Returns nothing if C is not positive definite in double precision or not finite. N^3/3 operations.
    static std::optional<CovarianceFactor> of(Eigen::MatrixXd covariance);

    double log_determinant() const override;

    /// Returns C^-1 B.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const override;

    /// Returns C^-1, both triangles. 2 N^3/3 operations: the zeros of L are not multiplied.
    Eigen::MatrixXd inverse() const;

    /// Returns L; only its lower triangle is defined.
    const Eigen::MatrixXd& lower() const { return lower_; }

  private:
    explicit CovarianceFactor(Eigen::MatrixXd lower) : lower_(std::move(lower)) {}

    Eigen::MatrixXd lower_;
};

} // namespace dfdyn::tools
