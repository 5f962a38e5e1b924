// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/derivative_rows.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <cmath>

namespace dfdyn::tools {
namespace {

/// Sum over t of weights_t times the difference that begins t samples ago.
Eigen::VectorXd sum_of_differences(const Eigen::VectorXd& weights, int order, int lags) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(lags + 1);
    for (Eigen::Index t = 0; t < weights.size(); ++t) {
        row[t] += weights[t];
        row[t + 1] -= order * weights[t];
        if (order == 2) {
            row[t + 2] += weights[t];
        }
    }
    return row;
}

} // namespace

Eigen::VectorXd filtered_velocity_row(double beta, int lags) {
    Eigen::VectorXd row(lags + 1);
    row[0] = 1;
    for (Eigen::Index t = 1; t <= lags; ++t) {
        row[t] = std::pow(beta, t - 1) * (beta - 1);
    }
    return row;
}

Eigen::VectorXd filtered_acceleration_row(double beta, int lags) {
    Eigen::VectorXd row(lags + 1);
    row[0] = 1;
    for (Eigen::Index t = 1; t <= lags; ++t) {
        row[t] = t == 1 ? beta - 2 : std::pow(beta, t - 2) * (beta - 1) * (beta - 1);
    }
    return row;
}

Eigen::VectorXd filtered_velocity_row_slope(double beta, int lags) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(lags + 1);
    for (Eigen::Index t = 1; t <= lags; ++t) {
        slope[t] = std::pow(beta, t - 1) + static_cast<double>(t - 1) * std::pow(beta, t - 2) * (beta - 1);
    }
    return slope;
}

Eigen::VectorXd filtered_acceleration_row_slope(double beta, int lags) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(lags + 1);
    for (Eigen::Index t = 1; t <= lags; ++t) {
        slope[t] = t == 1 ? 1
                          : 2 * std::pow(beta, t - 2) * (beta - 1) +
                                static_cast<double>(t - 2) * std::pow(beta, t - 3) * (beta - 1) * (beta - 1);
    }
    return slope;
}

Eigen::VectorXd polynomial_derivative_row(int order, int degree, int lags) {
    Eigen::MatrixXd powers(lags + 1,
                           degree + 1); // of time in windows: 0 at the newest sample, -1 at the oldest
    for (Eigen::Index lag = 0; lag <= lags; ++lag) {
        for (Eigen::Index power = 0; power <= degree; ++power) {
            powers(lag, power) = std::pow(-static_cast<double>(lag) / lags, static_cast<double>(power));
        }
    }
    const Eigen::MatrixXd fit = pseudo_inverse(powers);
    return fit.row(order).transpose();
}

Eigen::VectorXd unit_polynomial_derivative_row(int order, int degree, int lags) {
    const double factorial = std::tgamma(order + 1);
    return factorial / std::pow(lags, order) * polynomial_derivative_row(order, degree, lags);
}

Eigen::VectorXd mean_difference_row(int order, double beta, int lags) {
    Eigen::VectorXd weights(lags + 1 - order);
    for (Eigen::Index t = 0; t < weights.size(); ++t) {
        weights[t] = std::pow(beta, t);
    }
    return sum_of_differences(weights / weights.sum(), order, lags);
}

Eigen::VectorXd mean_difference_row_slope(int order, double beta, int lags) {
    Eigen::VectorXd weights(lags + 1 - order);
    Eigen::VectorXd slopes(weights.size());
    for (Eigen::Index t = 0; t < weights.size(); ++t) {
        weights[t] = std::pow(beta, t);
        slopes[t] = t == 0 ? 0 : static_cast<double>(t) * std::pow(beta, t - 1);
    }
    const double sum = weights.sum();
    return sum_of_differences(slopes / sum - weights * (slopes.sum() / (sum * sum)), order, lags);
}

} // namespace dfdyn::tools
