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

} // namespace dfdyn::tools
