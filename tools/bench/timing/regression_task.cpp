// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/regression_task.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <random>

namespace dfdyn::tools {

namespace {

RegressionTask::Matrix random_matrix(std::mt19937_64& engine, int rows, int columns) {
    std::normal_distribution<double> normal;
    return RegressionTask::Matrix::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

} // namespace

RegressionTask::RegressionTask(int columns) : rows_(distinct_rows, columns) {
    std::mt19937_64 engine(1);
    const int count = columns / 2;
    const Matrix input = random_matrix(engine, distinct_rows, inputs);
    const Matrix angle = input * random_matrix(engine, inputs, count) / 4;
    rows_.leftCols(count) = angle.array().cos() / std::sqrt(count);
    rows_.rightCols(count) = angle.array().sin() / std::sqrt(count);
    const Matrix direction = random_matrix(engine, inputs, outputs) / 4;
    targets_ = 5 * (input * direction).array().sin().matrix() + random_matrix(engine, distinct_rows, outputs);
}

RegressionTask::Matrix RegressionTask::batch_predictions(int samples) const {
    const int rounds = samples / distinct_rows;
    Eigen::VectorXd times = Eigen::VectorXd::Constant(distinct_rows, rounds);
    times.head(samples % distinct_rows).array() += 1;
    Eigen::MatrixXd normal = rows_.transpose() * times.asDiagonal() * rows_;
    normal.diagonal().array() += 1 / prior_variance;
    const Eigen::MatrixXd right = rows_.transpose() * times.asDiagonal() * targets_;
    return rows_ * normal.ldlt().solve(right);
}

double relative_error(const RegressionTask::Matrix& predictions, const RegressionTask::Matrix& expected) {
    if (!predictions.allFinite()) {
        return std::numeric_limits<double>::infinity();
    }
    const double rms = expected.norm() / std::sqrt(static_cast<double>(expected.size()));
    return (predictions - expected).cwiseAbs().maxCoeff() / rms;
}

} // namespace dfdyn::tools
