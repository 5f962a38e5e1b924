// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Least squares of one output by columns of any sign and columns whose coefficients must not be negative.
struct SignedFit {
    double left = 1;              ///< share of the output's variance that is left; 1 for a constant output
    Eigen::VectorXd coefficients; ///< of the columns that must not be negative
};

/// `output`: T. `free`: T x f; an offset is always there. `not_negative`: T x s, s <= 5. A column that is
/// constant, or a combination of the free ones, to 1e-6 counts for nothing. Cost: T (f + s)^2, and 2^s
/// systems of s equations.
SignedFit fit_signed(const Eigen::VectorXd& output, const Eigen::MatrixXd& free,
                     const Eigen::MatrixXd& not_negative);

/// What is left of each column, T x c, beside an offset and the columns of `free`. Cost: T f (f + c).
Eigen::MatrixXd left_of_columns(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& free);

} // namespace dfdyn::tools
