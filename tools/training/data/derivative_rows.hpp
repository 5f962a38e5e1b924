// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Velocity row of eq:input_locations_features_vel_acc with alpha_1 = 1, lags 0 … M: 1, then beta^(t-1) (beta
/// - 1).
Eigen::VectorXd filtered_velocity_row(double beta, int lags);

/// Acceleration row of the same equation with alpha_2 = 1: 1, beta - 2, then beta^(t-2) (beta - 1)^2.
Eigen::VectorXd filtered_acceleration_row(double beta, int lags);

/// Derivatives of the two rows with respect to beta.
Eigen::VectorXd filtered_velocity_row_slope(double beta, int lags);
Eigen::VectorXd filtered_acceleration_row_slope(double beta, int lags);

/// The row whose product with a lag window is, up to a positive factor, the derivative of the given order at
/// the newest sample of the least-squares polynomial of that degree (one-sided Savitzky-Golay). 0 <= order <=
/// degree <= lags.
Eigen::VectorXd polynomial_derivative_row(int order, int degree, int lags);

/// The same derivative per sample period to that order: exact for polynomials up to `degree`.
Eigen::VectorXd unit_polynomial_derivative_row(int order, int degree, int lags);

/// Weighted mean of the window's differences of the given order (1 or 2), weight beta^t for the difference
/// that begins t samples ago: the filters of eq:input_locations_features_vel_acc, cut where the differences
/// run out of the window and divided by the sum of their weights. Exact for polynomials of degree `order`,
/// per sample period to that order. order <= lags.
Eigen::VectorXd mean_difference_row(int order, double beta, int lags);

/// Its derivative with respect to beta.
Eigen::VectorXd mean_difference_row_slope(int order, double beta, int lags);

} // namespace dfdyn::tools
