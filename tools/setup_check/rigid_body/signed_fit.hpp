// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Least-squares fit of one output with columns of any sign and columns with nonnegative coefficients.
struct SignedFit {
    double left = 1;              ///< remaining share of the output's variance; 1 for a constant output
    Eigen::VectorXd coefficients; ///< of the columns with nonnegative coefficients
};

/// Fits `output` (T) with an offset, the columns `free` (T x f) and the columns `not_negative` (T x s). A
/// column that is constant or a combination of the free ones, within 1e-6, is ignored. Method: nonnegative
/// least squares of the normal equations (Lawson and Hanson, Solving Least Squares Problems, 1974, ch. 23).
/// Cost: T (f + s)^2, and at most 10 s systems of s equations.
SignedFit fit_signed(const Eigen::VectorXd& output, const Eigen::MatrixXd& free,
                     const Eigen::MatrixXd& not_negative);

/// Returns the residual of each column, T x c, after a fit with an offset and the columns of `free`. Cost: T
/// f (f + c).
Eigen::MatrixXd left_of_columns(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& free);

} // namespace dfdyn::tools
