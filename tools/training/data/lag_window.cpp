// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/lag_window.hpp"

#include "tools/base/numerics/linear_algebra.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {
namespace {

constexpr double held_fraction = 1e-3; // of the largest joint's standard deviation
// rad (m). A brake or a gear yields by some 0.3 mrad with the arm, and a fine encoder measures that as
// motion: scaled to unit deviation, a later motion of that joint would be an input of hundreds of deviations.
// The types of the joints are unknown here, and a slide of +-1 mm (7e-4 m) is to be learned.
constexpr double held_deviation = 5e-4;
// of the noise: also the mean of fifty positions of an encoder that toggles is no motion
constexpr double held_multiple = 30;
// of |r| times the joint's standard deviation; rounding errors are about 1e-15
constexpr double rounding_fraction = 1e-10;
constexpr double rounding_step = 1e-6; // of the joint's standard deviation
constexpr double pooled_floor = 1e-6;  // of a typical joint's standard deviation
constexpr std::size_t block_rows = 512;

/// Triangular factor of `factor` with the rows appended.
Eigen::MatrixXd stacked_factor(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd stacked(factor.rows() + rows.rows(), factor.cols());
    stacked << factor, rows;
    return triangular_factor(stacked);
}

RowList block_of(const RowList& rows, std::size_t first) {
    const std::size_t last = std::min(first + block_rows, rows.size());
    return {rows.begin() + static_cast<std::ptrdiff_t>(first),
            rows.begin() + static_cast<std::ptrdiff_t>(last)};
}

Eigen::RowVectorXd window_means(const Eigen::MatrixXd& positions, const RowList& rows, int lags) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(positions.cols() * (lags + 1));
    for (std::size_t first = 0; first < rows.size(); first += block_rows) {
        sum += lag_windows(positions, block_of(rows, first), lags).colwise().sum();
    }
    return sum / static_cast<double>(rows.size());
}

/// Returns the smallest change of a joint from a row to the next that exceeds `rounding`; infinite if there
/// is none.
double smallest_step(const Eigen::MatrixXd& positions, const RowList& rows, Eigen::Index joint,
                     double rounding) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Eigen::Index row : rows) {
        const double step = row > 0 ? std::abs(positions(row, joint) - positions(row - 1, joint)) : 0;
        smallest = step > rounding ? std::min(smallest, step) : smallest;
    }
    return smallest;
}

/// Returns the standard deviation of white noise with the third differences of a joint's windows, or the
/// differences of the highest order that they have.
double white_noise(const Eigen::MatrixXd& factor) {
    Eigen::VectorXd row = Eigen::VectorXd::Unit(factor.cols(), 0);
    for (Eigen::Index order = 1; order <= std::min<Eigen::Index>(3, factor.cols() - 1); ++order) {
        for (Eigen::Index lag = order; lag > 0; --lag) {
            row[lag] -= row[lag - 1];
        }
    }
    return (factor.triangularView<Eigen::Upper>() * row).norm() / row.norm();
}

} // namespace

Eigen::MatrixXd lag_windows(const Eigen::MatrixXd& positions, const RowList& rows, int lags) {
    const Eigen::Index width = lags + 1;
    Eigen::MatrixXd windows(static_cast<Eigen::Index>(rows.size()), positions.cols() * width);
    for (Eigen::Index joint = 0; joint < positions.cols(); ++joint) {
        for (Eigen::Index lag = 0; lag < width; ++lag) {
            for (Eigen::Index t = 0; t < windows.rows(); ++t) {
                windows(t, joint * width + lag) = positions(rows[static_cast<std::size_t>(t)] - lag, joint);
            }
        }
    }
    return windows;
}

LagSpread::LagSpread(const Eigen::MatrixXd& positions, const RowList& rows, int lags) : lags_(lags) {
    const Eigen::Index width = lags + 1;
    const Eigen::RowVectorXd means = window_means(positions, rows, lags);
    factors_.assign(static_cast<std::size_t>(positions.cols()), Eigen::MatrixXd::Zero(width, width));
    for (std::size_t first = 0; first < rows.size(); first += block_rows) {
        Eigen::MatrixXd windows = lag_windows(positions, block_of(rows, first), lags);
        windows.rowwise() -= means;
        for (std::size_t joint = 0; joint < factors_.size(); ++joint) {
            factors_[joint] = stacked_factor(
                factors_[joint], windows.middleCols(static_cast<Eigen::Index>(joint) * width, width));
        }
    }
    for (Eigen::MatrixXd& factor : factors_) {
        factor /= std::sqrt(static_cast<double>(rows.size()));
        position_deviation_.push_back(factor.col(0).norm());
    }
    const double widest = *std::max_element(position_deviation_.begin(), position_deviation_.end());
    for (std::size_t joint = 0; joint < factors_.size(); ++joint) {
        const double deviation = position_deviation_[joint];
        const double step =
            smallest_step(positions, rows, static_cast<Eigen::Index>(joint), rounding_step * deviation);
        held_.push_back(deviation <= held_fraction * widest &&
                        (deviation <= held_deviation ||
                         deviation <= held_multiple * std::max(step, white_noise(factors_[joint]))));
    }
}

std::vector<std::size_t> LagSpread::held_joints() const {
    std::vector<std::size_t> result;
    for (std::size_t joint = 0; joint < held_.size(); ++joint) {
        if (held_[joint]) {
            result.push_back(joint);
        }
    }
    return result;
}

double LagSpread::deviation(Eigen::Index joint, const Eigen::VectorXd& row) const {
    if (held_[static_cast<std::size_t>(joint)]) {
        return 0;
    }
    const auto index = static_cast<std::size_t>(joint);
    const double deviation = (factors_[index].triangularView<Eigen::Upper>() * row).norm();
    return deviation > rounding_fraction * row.norm() * position_deviation_[index] ? deviation : 0;
}

Eigen::VectorXd LagSpread::deviation_gradient(Eigen::Index joint, const Eigen::VectorXd& row) const {
    const auto factor = factors_[static_cast<std::size_t>(joint)].triangularView<Eigen::Upper>();
    const Eigen::VectorXd product = factor * row;
    return factor.transpose() * product / product.norm();
}

Eigen::MatrixXd LagSpread::pooled_factor() const {
    const Eigen::Index width = lags_ + 1;
    Eigen::MatrixXd pooled = Eigen::MatrixXd::Zero(width, width);
    int moving = 0;
    for (Eigen::Index joint = 0; joint < joints(); ++joint) {
        const auto index = static_cast<std::size_t>(joint);
        if (held_[index]) {
            continue;
        }
        pooled = stacked_factor(pooled, factors_[index] / position_deviation_[index]);
        ++moving;
    }
    pooled /= std::sqrt(std::max(moving, 1));
    return stacked_factor(pooled, pooled_floor * Eigen::MatrixXd::Identity(width, width));
}

} // namespace dfdyn::tools
