// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/row_weight.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double presliding_travel_rad = 3e-3;
constexpr double presliding_travel_m = 3e-4;
constexpr double standing_s = 0.3;                 ///< shortest standstill
constexpr double fade_s = 0.1;                     ///< ramp between weights 0 and 1
constexpr double longest_end_s = 2;                ///< longest ramp at the ends of a segment
constexpr double end_share = 1.0 / 6;              ///< largest share of a segment that a ramp covers
constexpr double least_standstill_deviation = 0.1; ///< of the output's standard deviation
constexpr double least_moving = 0.1; ///< of the rows: a joint that moves in fewer rows keeps all weights

double faded(double share) {
    const double sine = std::sin(std::numbers::pi / 2 * std::clamp(share, 0.0, 1.0));
    return sine * sine;
}

Eigen::Index rows_of(const MeasuredMotion& measured, double time_s) {
    return std::max<Eigen::Index>(1, std::llround(time_s * measured.rate_hz));
}

/// Marks the rows within any window of `standing_s` in which the joint travels less than `presliding_travel`.
std::vector<bool> stationary_rows(const MeasuredMotion& measured, Eigen::Index joint,
                                  double presliding_travel) {
    const Eigen::Index window = rows_of(measured, standing_s);
    std::vector<bool> standing(static_cast<std::size_t>(measured.time_s.size()), false);
    for (const Stretch& stretch : measured.stretches) {
        const auto position = measured.motion.position.col(joint).segment(stretch.first, stretch.count);
        for (Eigen::Index first = 0; first + window <= stretch.count; ++first) {
            const auto part = position.segment(first, window);
            if (part.maxCoeff() - part.minCoeff() < presliding_travel) {
                std::fill_n(standing.begin() + stretch.first + first, window, true);
            }
        }
    }
    return standing;
}

/// Standard deviation of a joint's output within its standstills, after subtraction of the fitted rigid-body
/// torque and of the mean of each standstill. Relative to the standard deviation of the output.
double standstill_deviation(const std::vector<bool>& standing, const Eigen::VectorXd& output,
                            const Eigen::VectorXd& torque) {
    const double square = torque.squaredNorm(); // 0 at a joint that moves no mass
    const Eigen::VectorXd error = output - (square > 0 ? output.dot(torque) / square : 0) * torque;
    double squares = 0;
    double rows = 0;
    for (Eigen::Index first = 0; first < error.size();) {
        Eigen::Index last = first;
        while (last < error.size() && standing[static_cast<std::size_t>(last)]) {
            ++last;
        }
        if (last > first) {
            const auto part = error.segment(first, last - first).array();
            squares += (part - part.mean()).square().sum();
            rows += static_cast<double>(last - first);
        }
        first = last + 1;
    }
    const double variance = (output.array() - output.mean()).square().mean();
    return rows > 0 && variance > 0 ? std::sqrt(squares / rows / variance) : 0;
}

/// Number of rows since the last row that is `off`, at most `most`.
Eigen::VectorXd rows_since(const std::vector<bool>& off, Eigen::Index most) {
    Eigen::VectorXd result(std::ssize(off));
    Eigen::Index since = most;
    for (Eigen::Index row = 0; row < result.size(); ++row) {
        since = off[static_cast<std::size_t>(row)] ? 0 : std::min(since + 1, most);
        result[row] = static_cast<double>(since);
    }
    return result;
}

/// Weights that rise from 0 at the rows that are `off` to 1 over `fade` rows.
Eigen::VectorXd ramped_weight(const std::vector<bool>& off, Eigen::Index fade) {
    const Eigen::VectorXd until = rows_since({off.rbegin(), off.rend()}, fade).reverse();
    return (rows_since(off, fade).cwiseMin(until) / static_cast<double>(fade)).unaryExpr(&faded);
}

Eigen::VectorXd moving_weight(const MeasuredMotion& measured, const Eigen::MatrixXd& torques,
                              Eigen::Index joint, bool prismatic) {
    const std::vector<bool> standing =
        stationary_rows(measured, joint, prismatic ? presliding_travel_m : presliding_travel_rad);
    const double moving = static_cast<double>(std::ranges::count(standing, false));
    if (moving < least_moving * static_cast<double>(standing.size()) ||
        standstill_deviation(standing, measured.outputs.col(joint), torques.col(joint)) <
            least_standstill_deviation) {
        return Eigen::VectorXd::Ones(std::ssize(standing));
    }
    return ramped_weight(standing, rows_of(measured, fade_s));
}

} // namespace

Eigen::VectorXd end_row_weight(const MeasuredMotion& measured) {
    Eigen::VectorXd weight(measured.time_s.size());
    for (const Stretch& stretch : measured.stretches) {
        const double reach =
            std::min(longest_end_s * measured.rate_hz, end_share * static_cast<double>(stretch.count));
        for (Eigen::Index row = 0; row < stretch.count; ++row) {
            const auto inside = static_cast<double>(std::min(row, stretch.count - 1 - row)) + 0.5;
            weight[stretch.first + row] = faded(inside / reach);
        }
    }
    return weight;
}

Eigen::MatrixXd joint_row_weight(const Robot& robot, const MeasuredMotion& measured,
                                 const Eigen::MatrixXd& torques) {
    const Eigen::VectorXd ends = end_row_weight(measured);
    Eigen::MatrixXd weight(ends.size(), measured.motion.position.cols());
    for (Eigen::Index joint = 0; joint < weight.cols(); ++joint) {
        const bool prismatic = robot.joints[static_cast<std::size_t>(joint)].prismatic;
        weight.col(joint) = ends.cwiseProduct(moving_weight(measured, torques, joint, prismatic));
    }
    return weight;
}

} // namespace dfdyn::tools
