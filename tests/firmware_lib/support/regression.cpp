// SPDX-License-Identifier: Apache-2.0
#include "tests/firmware_lib/support/regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <cmath>

namespace dfdyn::tests {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd standard_normal(std::mt19937_64& engine, int rows, int columns) {
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

void scale_badly(std::mt19937_64& engine, MatrixXd& rows) {
    std::uniform_real_distribution<double> exponent(-3, 3);
    for (auto column : rows.colwise()) {
        column *= std::pow(10, exponent(engine));
    }
}

void make_collinear(std::mt19937_64& engine, MatrixXd& rows) {
    const auto count = static_cast<int>(rows.rows());
    for (int j = 1; j < rows.cols(); j += 2) {
        rows.col(j) = rows.col(j - 1);
        if (j % 4 == 3) {
            rows.col(j) += 1e-3 * standard_normal(engine, count, 1);
        }
    }
}

MatrixXd fourier_features(std::mt19937_64& engine, int count, int columns) {
    constexpr int inputs = 6;
    const int features = (columns + 1) / 2;
    const MatrixXd frequencies = standard_normal(engine, inputs, features);
    const MatrixXd rates = standard_normal(engine, 1, inputs).cwiseAbs2().array() + 1;
    const MatrixXd phases = standard_normal(engine, 1, inputs);
    const VectorXd times = VectorXd::LinSpaced(count, 0, 0.01 * count);
    const MatrixXd motion = ((times * rates).rowwise() + phases.row(0)).array().sin();
    const MatrixXd arguments = motion * frequencies;
    MatrixXd rows(count, 2 * features);
    rows << arguments.array().cos(), arguments.array().sin();
    return rows.leftCols(columns) / std::sqrt(features);
}

MatrixXd random_rows(std::mt19937_64& engine, RegressionSize size, Columns columns) {
    if (columns == Columns::fourier_features) {
        return fourier_features(engine, size.rows, size.columns);
    }
    MatrixXd rows = standard_normal(engine, size.rows, size.columns);
    if (columns == Columns::badly_scaled) {
        scale_badly(engine, rows);
    } else if (columns == Columns::collinear) {
        make_collinear(engine, rows);
    }
    return rows;
}

MatrixXd rounded_to_float(const MatrixXd& matrix) { return matrix.cast<float>().cast<double>(); }

/// λ^(N-1-t) of row t.
VectorXd row_weights(const Regression& regression) {
    const int count = regression.row_count();
    return VectorXd::NullaryExpr(count, [&](Eigen::Index t) {
        return std::pow(regression.forgetting_factor, static_cast<double>(count - 1 - t));
    });
}

double prior_weight(const Regression& regression) {
    return std::pow(regression.forgetting_factor, regression.row_count() - 1);
}

} // namespace

Regression random_regression(std::mt19937_64& engine, RegressionSize size, Columns columns) {
    Regression regression;
    regression.rows = rounded_to_float(random_rows(engine, size, columns));
    const MatrixXd weights = standard_normal(engine, size.columns, size.outputs);
    regression.targets =
        rounded_to_float(regression.rows * weights + standard_normal(engine, size.rows, size.outputs));
    return regression;
}

Regression part(const Regression& whole, int begin, int end) {
    Regression result = whole;
    result.rows = whole.rows.middleRows(begin, end - begin);
    result.targets = whole.targets.middleRows(begin, end - begin);
    return result;
}

Regression with_prior(Regression regression, double prior_variance, double forgetting_factor) {
    regression.prior_variance = prior_variance;
    regression.forgetting_factor = forgetting_factor;
    return regression;
}

double BatchSolution::variance(const VectorXd& row) const {
    return information_root.transpose().triangularView<Eigen::Lower>().solve(row).squaredNorm();
}

VectorXd BatchSolution::parameter_variances() const {
    const auto columns = information_root.cols();
    const MatrixXd root =
        information_root.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(columns, columns));
    return root.rowwise().squaredNorm();
}

BatchSolution solve_by_qr(const Regression& regression) {
    const int count = regression.row_count();
    const int columns = regression.columns();
    const VectorXd roots = row_weights(regression).cwiseSqrt();
    MatrixXd stacked(count + columns, columns);
    stacked << roots.asDiagonal() * regression.rows,
        MatrixXd::Identity(columns, columns) *
            std::sqrt(prior_weight(regression) / regression.prior_variance);
    MatrixXd targets = MatrixXd::Zero(count + columns, regression.outputs());
    targets.topRows(count) = roots.asDiagonal() * regression.targets;
    const Eigen::HouseholderQR<MatrixXd> qr(stacked);
    const MatrixXd root = qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>();
    targets.applyOnTheLeft(qr.householderQ().adjoint());
    return {root.triangularView<Eigen::Upper>().solve(targets.topRows(columns)),
            root * std::sqrt(regression.forgetting_factor)};
}

NormalEquationsSolution solve_by_ldlt(const Regression& regression) {
    const int columns = regression.columns();
    const MatrixXd identity = MatrixXd::Identity(columns, columns);
    const MatrixXd weighted = row_weights(regression).asDiagonal() * regression.rows;
    const MatrixXd information = identity * (prior_weight(regression) / regression.prior_variance) +
                                 weighted.transpose() * regression.rows;
    const Eigen::LDLT<MatrixXd> factor(information);
    return {factor.solve(weighted.transpose() * regression.targets),
            factor.solve(identity) / regression.forgetting_factor};
}

double information_error(const BatchSolution& truth, const MatrixXd& weights) {
    return relative_error(truth.information_root * weights, truth.information_root * truth.weights);
}

double relative_error(const MatrixXd& value, const MatrixXd& truth) {
    return (value - truth).norm() / truth.norm();
}

double largest_relative_error(const VectorXd& value, const VectorXd& truth) {
    return (value - truth).cwiseQuotient(truth).cwiseAbs().maxCoeff();
}

} // namespace dfdyn::tests
