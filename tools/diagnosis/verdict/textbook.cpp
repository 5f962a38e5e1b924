// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/textbook.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Weighted least squares of columns that may be zero or combinations of each other.
struct WeightedFit {
    VectorXd scale;   ///< inverse weighted norms of the columns; 0 for a column of zeros
    MatrixXd inverse; ///< of the normal equations of the scaled columns
    VectorXd values;
};

WeightedFit weighted_fit(const MatrixXd& columns, const VectorXd& weight, const VectorXd& right) {
    constexpr double damping = 1e-8; // of the squared norm of each column
    const MatrixXd weighted = weight.asDiagonal() * columns;
    const VectorXd norm = columns.cwiseProduct(weighted).colwise().sum().cwiseSqrt();
    const VectorXd scale = (norm.array() > 0).select(norm.cwiseInverse(), 0);
    const Index count = columns.cols();
    const MatrixXd normal = scale.asDiagonal() * (columns.transpose() * weighted) * scale.asDiagonal();
    const MatrixXd inverse = solve_symmetric(MatrixXd(normal + damping * MatrixXd::Identity(count, count)),
                                             MatrixXd(MatrixXd::Identity(count, count)));
    const VectorXd moment = scale.asDiagonal() * (weighted.transpose() * right);
    return {scale, inverse, scale.asDiagonal() * (inverse * moment)};
}

/// Returns the sums of error times columns over blocks of time, p x blocks, without blocks of weight 0.
MatrixXd sums_of_blocks(const MatrixXd& columns, const VectorXd& weight, const VectorXd& error,
                        const VectorXd& time_s) {
    const double moving_s =
        (time_s[time_s.size() - 1] - time_s[0]) * weight.sum() / static_cast<double>(weight.size());
    const double block_s = std::clamp(moving_s / 20, 0.25, 1.0);
    std::vector<VectorXd> sums;
    double end_s = -std::numeric_limits<double>::infinity();
    for (Index row = 0; row < error.size(); ++row) {
        if (!(weight[row] > 0)) {
            continue;
        }
        if (time_s[row] >= end_s) {
            end_s = time_s[row] + block_s;
            sums.emplace_back(VectorXd::Zero(columns.cols()));
        }
        sums.back() += weight[row] * error[row] * columns.row(row).transpose();
    }
    MatrixXd result(columns.cols(), std::ssize(sums));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        result.col(static_cast<Index>(i)) = sums[i];
    }
    return result;
}

/// Returns the covariance of a fit from the sums over blocks; its diagonal is at least the one of white
/// noise.
MatrixXd covariance_of(const WeightedFit& fit, const MatrixXd& sums, const VectorXd& weight,
                       const VectorXd& error) {
    const auto blocks = static_cast<double>(sums.cols());
    const auto fitted = static_cast<double>((fit.scale.array() > 0).count());
    const MatrixXd gradient = fit.scale.asDiagonal() * fit.inverse * fit.scale.asDiagonal() * sums;
    MatrixXd covariance = blocks / std::max(blocks - fitted, 1.0) * (gradient * gradient.transpose()).eval();
    const double variance = weighted_mean_square(error, weight);
    for (Index i = 0; i < covariance.rows(); ++i) {
        const double white = variance * fit.scale[i] * fit.scale[i] * fit.inverse(i, i);
        covariance(i, i) = std::max(covariance(i, i), white);
    }
    return covariance;
}

/// Returns whether the fit of all columns determines the rigid body's factor: its column does not depend on
/// the others.
bool determines_gain(const WeightedFit& all) {
    constexpr double independent_share = 0.01; // share of the rigid body's column
    return all.scale[0] > 0 && all.inverse(0, 0) * independent_share < 1;
}

/// Applies the prior of the rigid body's factor (near 1), unless the data contradict it.
void expect_gain_of_one(MovingFit& fit) {
    fit.another_gain = contradicts_known_gain(fit.values[0], fit.covariance(0, 0));
    if (!fit.another_gain) {
        const double variance = fit.covariance(0, 0) + known_gain_deviation * known_gain_deviation;
        const VectorXd along = fit.covariance.col(0) / variance;
        fit.values += (1 - fit.values[0]) * along;
        fit.covariance -= (variance * along * along.transpose()).eval();
    }
}

} // namespace

MatrixXd textbook_columns(const DiagnosisSignals& signals, const VectorXd& rigid, Index output) {
    const RobotMotion& motion = signals.measured.motion;
    MatrixXd columns = MatrixXd::Zero(rigid.size(), 5);
    columns.col(0) = rigid;
    if (!signals.wrench()) {
        columns.col(1) = motion.acceleration.col(output);
        columns.col(2) = motion.velocity.col(output);
        columns.col(3) = signals.direction(output);
    }
    columns.col(4).setOnes();
    return columns;
}

bool contradicts_known_gain(double gain, double variance) {
    constexpr double contradicting_deviations = 3;
    const double apart = 1 - gain;
    return apart * apart > contradicting_deviations * contradicting_deviations *
                               (variance + known_gain_deviation * known_gain_deviation);
}

VectorXd row_weight(const DiagnosisSignals& signals, Index output) {
    const MatrixXd& weight = signals.measured.weight;
    return weight.size() > 0 ? VectorXd(weight.col(output)) : VectorXd(VectorXd::Ones(signals.rows()));
}

double weighted_mean_square(const VectorXd& error, const VectorXd& weight) {
    return weight.dot(error.cwiseAbs2()) / std::max(weight.sum(), 1.0);
}

VectorXd coefficients_with_gain(const MatrixXd& columns, const VectorXd& measured, double gain) {
    const VectorXd right = measured - gain * columns.col(0);
    VectorXd coefficients(columns.cols());
    coefficients << gain,
        weighted_fit(columns.rightCols(columns.cols() - 1), VectorXd::Ones(columns.rows()), right).values;
    return coefficients;
}

TextbookFit textbook_fit(const DiagnosisSignals& signals, const MatrixXd& measured, const MatrixXd& rigid,
                         Index rows) {
    TextbookFit fit{MatrixXd::Zero(5, measured.cols()), MatrixXd(measured.rows(), measured.cols())};
    for (Index output = 0; output < measured.cols(); ++output) {
        const MatrixXd columns = textbook_columns(signals, rigid.col(output), output);
        const MatrixXd fitted = columns.topRows(rows);
        const VectorXd right = measured.col(output).head(rows);
        const WeightedFit all = weighted_fit(fitted, VectorXd::Ones(rows), right);
        fit.coefficients.col(output) =
            determines_gain(all) ? all.values : coefficients_with_gain(fitted, right, 1);
        fit.prediction.col(output) = columns * fit.coefficients.col(output);
    }
    return fit;
}

MovingFit fit_moving_rows(const DiagnosisSignals& signals, const VectorXd& measured, const VectorXd& rigid,
                          Index output, bool gain_known) {
    MovingFit fit{textbook_columns(signals, rigid, output), VectorXd(5), MatrixXd::Zero(5, 5)};
    const VectorXd weight = row_weight(signals, output);
    const WeightedFit all = weighted_fit(fit.columns, weight, measured);
    const bool gain_seen = determines_gain(all);
    const Index first = gain_seen ? 0 : 1;
    const MatrixXd columns = fit.columns.rightCols(5 - first);
    const VectorXd right = gain_seen ? measured : VectorXd(measured - rigid);
    const WeightedFit found = gain_seen ? all : weighted_fit(columns, weight, right);
    const VectorXd error = right - columns * found.values;
    const MatrixXd sums = sums_of_blocks(columns, weight, error, signals.measured.time_s);
    fit.blocks = sums.cols();
    fit.values << VectorXd::Ones(first), found.values;
    fit.covariance.bottomRightCorner(5 - first, 5 - first) = covariance_of(found, sums, weight, error);
    if (gain_known && gain_seen) {
        expect_gain_of_one(fit);
    }
    return fit;
}

} // namespace dfdyn::tools
