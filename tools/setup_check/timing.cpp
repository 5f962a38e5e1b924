// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/recording/stretches.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Deviation of a row's positions from the cubic through its four neighbours, and its slope there.
struct Deviation {
    double of_position = 0, slope = 0;
};

Deviation deviation(const Recording& recording, std::size_t row, std::size_t joint) {
    double predicted = 0;
    double slope = 0;
    const double time_s = recording.time_s[row];
    for (std::size_t i : {row - 2, row - 1, row + 1, row + 2}) {
        double weight = 1;
        double derivative = 0; // of the logarithm of the weight
        for (std::size_t j : {row - 2, row - 1, row + 1, row + 2}) {
            if (i != j) {
                weight *= (time_s - recording.time_s[j]) / (recording.time_s[i] - recording.time_s[j]);
                derivative += 1 / (time_s - recording.time_s[j]);
            }
        }
        predicted += weight * recording.position.row(i)[joint];
        slope += weight * derivative * recording.position.row(i)[joint];
    }
    return {recording.position.row(row)[joint] - predicted, slope};
}

/// The common time error of the moving joints, over all rows.
struct StampError {
    double squares_s2 = 0, rows = 0;
    double total = 0,
           left = 0; ///< squared deviations of the positions, before and after a common time error

    void add(const std::vector<Deviation>& joints) {
        double product = 0;
        double square = 0;
        for (const Deviation& one : joints) {
            product += one.of_position * one.slope;
            square += one.slope * one.slope;
        }
        const double error_s = product / square;
        for (const Deviation& one : joints) {
            total += one.of_position * one.of_position;
            left += std::pow(one.of_position - error_s * one.slope, 2);
        }
        squares_s2 += error_s * error_s;
        rows += 1;
    }
    double rms_s() const {
        constexpr double of_neighbours =
            1.9; // variance of a deviation, relative to the variance of one row's error
        return std::sqrt(squares_s2 / rows / of_neighbours);
    }
};

StampError stamp_error(const Recording& recording) {
    constexpr double moving = 0.05; // rad/s (m/s)
    StampError error;
    for (std::size_t row = 2; row + 2 < recording.row_count(); ++row) {
        const auto at = recording.gap_before.begin() + static_cast<std::ptrdiff_t>(row);
        if (std::any_of(at - 1, at + 3, [](auto gap) { return gap != 0; })) {
            continue;
        }
        std::vector<Deviation> joints;
        for (std::size_t joint = 0; joint < recording.joint_count(); ++joint) {
            if (const Deviation one = deviation(recording, row, joint); std::abs(one.slope) > moving) {
                joints.push_back(one);
            }
        }
        if (joints.size() > 1) {
            error.add(joints);
        }
    }
    return error;
}

} // namespace

SetupFindings check_stamps(const Recording& recording) {
    constexpr double most_of_step = 0.15;
    constexpr double least_explained = 0.95;
    constexpr double fewest = 100;
    constexpr double longest_step_s = 0.025; // longer steps do not determine the motion between the rows
    const double step_s = median_step_s(recording);
    if (!(step_s < longest_step_s)) {
        return {};
    }
    const StampError error = stamp_error(recording);
    if (error.rows < fewest || !(error.left < (1 - least_explained) * error.total) ||
        error.rms_s() < most_of_step * step_s) {
        return {};
    }
    return {{SetupFault::clock, Severity::mistake, "t",
             "column t: expected the instants at which the positions were measured, found positions of all "
             "joints that are early or late by " +
                 rounded_text(1e3 * error.rms_s()) + " ms (rms) with rows " + rounded_text(1e3 * step_s) +
                 " ms apart: rounded or late time stamps; record t with more digits, or number the rows and "
                 "multiply by the step"}};
}

namespace {

constexpr double longest_delay_s = 0.25;
constexpr double delay_step_s = 0.005;
constexpr double shortest_delay_s = 0.008;

/// Delays that are compared: `count` of them on either side of 0, `rows` rows apart.
struct DelayGrid {
    Index rows = 1, count = 0;
    Index rows_of(Index i) const { return (i - count) * rows; }
    Index size() const { return 2 * count + 1; }
};

/// Logarithm of the remaining variance of a joint's output, relative to that without a delay, for each delay.
/// Rigid body and friction have free factors.
VectorXd log_ratios(const ArmRecording& arm, const RigidParts& parts, const std::vector<std::size_t>& rows,
                    const DelayGrid& grid, Index joint) {
    constexpr double exact_share = 1e-3; // that any model leaves
    const auto measured = columns_matrix(arm.recording.output);
    const Index reach = grid.count * grid.rows;
    std::vector<Index> states;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<Index>(rows[i]);
        if (row >= reach && row + reach < measured.rows()) {
            states.push_back(static_cast<Index>(i));
        }
    }
    MatrixXd shifted(std::ssize(states), grid.size());
    for (Index i = 0; i < shifted.rows(); ++i) {
        const auto row =
            static_cast<Index>(rows[static_cast<std::size_t>(states[static_cast<std::size_t>(i)])]);
        for (Index delay = 0; delay < grid.size(); ++delay) {
            shifted(i, delay) = measured(row + grid.rows_of(delay), joint);
        }
    }
    MatrixXd model(arm.recorded.motion.rows(), 4);
    model << parts.gravity.col(joint), parts.inertia.col(joint), friction_columns(arm.recorded.motion, joint);
    const MatrixXd left = left_of_columns(shifted, model(states, Eigen::all));
    const MatrixXd varied = shifted.rowwise() - shifted.colwise().mean();
    VectorXd shares = VectorXd::Ones(grid.size());
    for (Index delay = 0; delay < grid.size(); ++delay) {
        if (const double variance = varied.col(delay).squaredNorm(); variance > 0) {
            shares[delay] = std::max(exact_share, left.col(delay).squaredNorm() / variance);
        }
    }
    return (shares / shares[grid.count]).array().log();
}

/// Returns whether a joint's own best delay is clear and near to `delay`, an index in the grid.
bool agrees(const VectorXd& ratios, const DelayGrid& grid, Index delay) {
    constexpr double clearly = -0.1;
    Index best = 0;
    const double least = ratios.minCoeff(&best);
    const double apart = static_cast<double>(std::abs(best - delay));
    return least < clearly &&
           apart <= std::max(1.0, 0.25 * static_cast<double>(std::abs(delay - grid.count)));
}

SetupFinding delayed(const ArmRecording& arm, const std::vector<std::size_t>& joints, Index rows,
                     double step_s, double ratio) {
    const std::string ms = rounded_text(1e3 * step_s * static_cast<double>(std::abs(rows)));
    const std::string columns = listed(arm.recording.output.names);
    return {SetupFault::clock, Severity::warning, columns,
            "columns " + columns +
                ": expected outputs at the instants of the positions, found outputs about " + ms + " ms " +
                (rows > 0 ? "late" : "early") + " at joint " + counted_from_one(joints) +
                ": with outputs of " + std::to_string(std::abs(rows)) + " rows " +
                (rows > 0 ? "later" : "earlier") + " the model leaves " + percent(std::exp(ratio)) +
                " of the residual; record both with one clock, or move the columns by these rows"};
}

} // namespace

SetupFindings check_output_delay(const ArmRecording& arm, const RigidParts& parts,
                                 const std::vector<std::size_t>& rows) {
    constexpr double clearly = -0.15;
    constexpr std::size_t fewest = 2;
    if (arm.wrench()) {
        return {};
    }
    const double step_s = median_step_s(arm.recording);
    const auto spacing = static_cast<Index>(std::max(1.0, std::round(delay_step_s / step_s)));
    const DelayGrid grid{spacing, static_cast<Index>(longest_delay_s / step_s) / spacing};
    std::vector<std::size_t> moving;
    std::vector<VectorXd> ratios;
    VectorXd mean = VectorXd::Zero(grid.size());
    for (Index joint = 0; joint < arm.counted(); ++joint) {
        if (swings(arm.recorded.motion, joint, 1)) {
            moving.push_back(static_cast<std::size_t>(joint));
            ratios.push_back(log_ratios(arm, parts, rows, grid, joint));
            mean += ratios.back();
        }
    }
    mean /= static_cast<double>(std::max<std::size_t>(moving.size(), 1));
    Index delay = 0;
    const double ratio = mean.minCoeff(&delay);
    const double delay_s = step_s * static_cast<double>(std::abs(grid.rows_of(delay)));
    if (ratio > clearly || delay_s < std::max(shortest_delay_s, 1.5 * step_s)) {
        return {};
    }
    std::vector<std::size_t> agreeing;
    for (std::size_t i = 0; i < moving.size(); ++i) {
        if (agrees(ratios[i], grid, delay)) {
            agreeing.push_back(moving[i]);
        }
    }
    if (agreeing.size() < fewest || 2 * agreeing.size() < moving.size()) {
        return {};
    }
    return {delayed(arm, agreeing, grid.rows_of(delay), step_s, ratio)};
}

} // namespace dfdyn::tools
