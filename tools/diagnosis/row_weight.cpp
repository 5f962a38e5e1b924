// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/row_weight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double least_travel = 3e-3; ///< rad (m)
constexpr double standing_s = 0.5;    ///< at least
constexpr double fade_s = 0.1;        ///< from rows that tell nothing to such that tell all
constexpr double least_moving = 0.1;  ///< of the rows, of a joint that moves

double faded(double share) {
    const double sine = std::sin(std::numbers::pi / 2 * std::clamp(share, 0.0, 1.0));
    return sine * sine;
}

/// Rows of a stretch where a joint travels less than `least_travel` in some `standing_s` around.
std::vector<bool> standing_rows(const Eigen::VectorXd& position, Eigen::Index window) {
    std::vector<bool> standing(static_cast<std::size_t>(position.size()), false);
    for (Eigen::Index first = 0; first + window <= position.size(); ++first) {
        const auto part = position.segment(first, window);
        if (part.maxCoeff() - part.minCoeff() < least_travel) {
            std::fill_n(standing.begin() + first, window, true);
        }
    }
    return standing;
}

/// Rising from 0 where `off`, over `fade` rows.
Eigen::VectorXd weight_beside(const std::vector<bool>& off, Eigen::Index fade) {
    const auto rows = std::ssize(off);
    Eigen::VectorXd weight(rows);
    Eigen::Index since = fade;
    for (Eigen::Index row = 0; row < rows; ++row) {
        since = off[static_cast<std::size_t>(row)] ? 0 : since + 1;
        weight[row] = faded(static_cast<double>(since) / static_cast<double>(fade));
    }
    Eigen::Index until = fade;
    for (Eigen::Index row = rows - 1; row >= 0; --row) {
        until = off[static_cast<std::size_t>(row)] ? 0 : until + 1;
        weight[row] = std::min(weight[row], faded(static_cast<double>(until) / static_cast<double>(fade)));
    }
    return weight;
}

Eigen::VectorXd moving_weight(const MeasuredMotion& measured, Eigen::Index joint) {
    const auto rows_of = [&](double time_s) {
        return std::max<Eigen::Index>(1, std::llround(time_s * measured.rate_hz));
    };
    Eigen::VectorXd weight(measured.time_s.size());
    for (const Stretch& stretch : measured.stretches) {
        const Eigen::VectorXd position =
            measured.motion.position.col(joint).segment(stretch.first, stretch.count);
        weight.segment(stretch.first, stretch.count) =
            weight_beside(standing_rows(position, rows_of(standing_s)), rows_of(fade_s));
    }
    return weight.mean() < least_moving ? Eigen::VectorXd::Ones(weight.size()) : weight;
}

} // namespace

Eigen::VectorXd end_row_weight(const MeasuredMotion& measured) {
    const double reach = measured.rate_hz / measured.smoothing_hz.minCoeff(); // of the low pass, half
    Eigen::VectorXd weight(measured.time_s.size());
    for (const Stretch& stretch : measured.stretches) {
        for (Eigen::Index row = 0; row < stretch.count; ++row) {
            const auto inside = static_cast<double>(std::min(row, stretch.count - 1 - row)) + 0.5;
            weight[stretch.first + row] = faded(inside / reach);
        }
    }
    return weight;
}

Eigen::MatrixXd joint_row_weight(const MeasuredMotion& measured) {
    const Eigen::VectorXd ends = end_row_weight(measured);
    Eigen::MatrixXd weight(ends.size(), measured.motion.position.cols());
    for (Eigen::Index joint = 0; joint < weight.cols(); ++joint) {
        weight.col(joint) = ends.cwiseProduct(moving_weight(measured, joint));
    }
    return weight;
}

} // namespace dfdyn::tools
