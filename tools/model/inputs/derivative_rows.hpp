// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns the velocity row of DFSR (paper, Section V-C) with alpha_1 = 1, for lags 0 … M: 1, then beta^(t-1)
/// (beta - 1).
Eigen::VectorXd filtered_velocity_row(double beta, int lags);

/// Returns the acceleration row of DFSR (paper, Section V-C) with alpha_2 = 1: 1, beta - 2, then beta^(t-2)
/// (beta - 1)^2.
Eigen::VectorXd filtered_acceleration_row(double beta, int lags);

/// Return the derivatives of the two rows with respect to beta.
Eigen::VectorXd filtered_velocity_row_slope(double beta, int lags);
Eigen::VectorXd filtered_acceleration_row_slope(double beta, int lags);

/// Returns a one-sided Savitzky-Golay row, up to a positive factor: its product with a lag window is a
/// derivative of the least-squares polynomial of `degree` at the newest sample. 0 <= order <= degree <= lags.
Eigen::VectorXd polynomial_derivative_row(int order, int degree, int lags);

/// Returns the row of the same derivative in units of the sample period: exact for polynomials up to
/// `degree`.
Eigen::VectorXd unit_polynomial_derivative_row(int order, int degree, int lags);

/// Returns the row of the weighted mean of the window's differences of the given order (1 or 2). A difference
/// that begins t samples ago has the weight beta^t. These are the filters of DFSR (paper, Section V-C),
/// truncated to complete differences and divided by the sum of their weights. Exact for polynomials of degree
/// `order`, in units of the sample period. order <= lags.
Eigen::VectorXd mean_difference_row(int order, double beta, int lags);

/// Returns the derivative of mean_difference_row() with respect to beta.
Eigen::VectorXd mean_difference_row_slope(int order, double beta, int lags);

} // namespace dfdyn::tools
