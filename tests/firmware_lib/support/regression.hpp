// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <random>

namespace dfdyn::tests {

/// A regression targets = rows·w + e with e ~ N(0, 1) and w ~ N(0, prior_variance I). Every number is
/// representable as float, so that learners in either precision solve the same problem.
struct Regression {
    Eigen::MatrixXd rows;    ///< N × p
    Eigen::MatrixXd targets; ///< N × m
    double prior_variance = 1;
    double forgetting_factor = 1; ///< applied after each learned row

    [[nodiscard]] int row_count() const { return static_cast<int>(rows.rows()); }
    [[nodiscard]] int columns() const { return static_cast<int>(rows.cols()); }
    [[nodiscard]] int outputs() const { return static_cast<int>(targets.cols()); }
};

/// Kinds of columns of a random regression.
enum class Columns {
    independent,
    badly_scaled, ///< column norms between 1e-3 and 1e3
    collinear,    ///< every second column is a copy of its neighbour, half of the copies with noise of 1e-3
    fourier_features, ///< cosines and sines along a smooth motion
};

struct RegressionSize {
    int rows;
    int columns;
    int outputs;
};

Regression random_regression(std::mt19937_64& engine, RegressionSize size, Columns columns);

/// Returns the rows `begin` … `end - 1` of a regression.
Regression part(const Regression& whole, int begin, int end);

Regression with_prior(Regression regression, double prior_variance, double forgetting_factor);

/// The batch solution by Householder QR of the stacked rows and prior, in double. Row t has the weight
/// λ^(N-t) and the prior λ^(N-1); after the last row the covariance is divided by λ once more.
struct BatchSolution {
    Eigen::MatrixXd weights;          ///< p × m
    Eigen::MatrixXd information_root; ///< upper triangular R, R'R = P⁻¹

    [[nodiscard]] double variance(const Eigen::VectorXd& row) const;
    [[nodiscard]] Eigen::VectorXd parameter_variances() const;
};

BatchSolution solve_by_qr(const Regression& regression);

/// The same from the normal equations by LDLT: loses twice the digits, but is independent of QR.
struct NormalEquationsSolution {
    Eigen::MatrixXd weights;    ///< p × m
    Eigen::MatrixXd covariance; ///< P
};

NormalEquationsSolution solve_by_ldlt(const Regression& regression);

/// Returns the relative error of weights in the norm of the batch solution's information, |R (w - ŵ)| / |R
/// ŵ|. Each direction counts as far as data and prior determine it, for any scales of the columns.
double information_error(const BatchSolution& truth, const Eigen::MatrixXd& weights);

/// Returns |value - truth| / |truth| over all elements together.
double relative_error(const Eigen::MatrixXd& value, const Eigen::MatrixXd& truth);

/// Returns the largest |value - truth| / |truth| of an element.
double largest_relative_error(const Eigen::VectorXd& value, const Eigen::VectorXd& truth);

} // namespace dfdyn::tests
