// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows in which a joint is faster than a tenth of its largest speed. Static friction may hold any torque up
/// to the break-away torque, a different one in each posture, and smooth functions of a few postures would
/// describe these.
std::vector<Index> fast_rows(const RobotMotion& motion, Index joint) {
    constexpr double share = 0.1;
    const VectorXd speed = motion.velocity.col(joint).cwiseAbs();
    const double least = share * speed.maxCoeff();
    std::vector<Index> rows;
    for (Index row = 0; row < speed.size(); ++row) {
        if (speed[row] > least) {
            rows.push_back(row);
        }
    }
    return rows;
}

/// Returns the number of independent rows: derivatives of rows within 0.04 s share two thirds of their
/// window.
double independent_rows(const ArmRecording& arm, std::size_t rows) {
    constexpr double apart_s = 0.04;
    const std::vector<double>& time_s = arm.recording.time_s;
    const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(arm.recorded.motion.rows());
    return static_cast<double>(rows) * std::min(1.0, step_s / apart_s);
}

/// Coulomb friction with a soft transition between its directions, T: at a third of the largest speed. In
/// slow motion presliding takes a large part of a move.
VectorXd soft_friction(const RobotMotion& motion, Index joint) {
    constexpr double share = 0.3;
    const VectorXd velocity = motion.velocity.col(joint);
    return (velocity / (share * velocity.cwiseAbs().maxCoeff())).array().tanh();
}

/// Remaining shares of an output's variance for two models, while the joint moves.
struct Comparison {
    double by_robot = 0; ///< the robot's body, with any payload and friction
    double by_any = 0;   ///< smooth functions of the motion and friction, per remaining degree of freedom
};

/// Compares the models at a joint; empty if it moves in too few rows for the number of functions.
std::optional<Comparison> compare(const ArmRecording& arm, const RigidParts& parts, const MatrixXd& smooth,
                                  Index joint) {
    constexpr double least_free = 0.5;
    const RobotMotion& motion = arm.recorded.motion;
    const std::vector<Index> rows = fast_rows(motion, joint);
    const double free_share =
        1 - static_cast<double>(smooth.cols()) / std::max(independent_rows(arm, rows.size()), 1.0);
    if (free_share < least_free) {
        return std::nullopt;
    }
    const VectorXd output = arm.output(joint)(rows);
    const auto with_soft_friction = [&](const MatrixXd& columns) {
        MatrixXd all(columns.rows(), columns.cols() + 1);
        all << columns, soft_friction(motion, joint);
        return MatrixXd(all(rows, Eigen::all));
    };
    const SignedFit any =
        fit_signed(output, smooth(rows, Eigen::all), with_soft_friction(friction_columns(motion, joint)));
    return Comparison{left_by(output, with_soft_friction(expected_columns(arm, motion, parts, joint))),
                      any.left / free_share};
}

} // namespace

SetupFindings check_robot_match(const ArmRecording& arm, const RigidParts& parts) {
    constexpr double least_share = 0.01;
    constexpr double least_log_ratio = 1.2;
    constexpr double least_residual = 0.06;
    constexpr int turns = 2;
    if (arm.wrench()) {
        return {};
    }
    const RobotMotion& motion = arm.recorded.motion;
    const VectorXd weight = deviations(parts.gravity);
    const MatrixXd smooth = smooth_columns(motion);
    std::vector<std::string> columns;
    double ratio = 0;
    double left = 0;
    for (Index k = 0; k < arm.counted(); ++k) {
        if (!(weight[k] > least_gravity_share * weight.maxCoeff()) || !swings(motion, k, turns)) {
            continue;
        }
        if (const std::optional<Comparison> found = compare(arm, parts, smooth, k)) {
            ratio += std::log(std::max(found->by_robot, least_share) / std::max(found->by_any, least_share));
            left += found->by_robot;
            columns.push_back(arm.recording.output.names[static_cast<std::size_t>(k)]);
        }
    }
    const auto count = static_cast<double>(columns.size());
    if (columns.empty() || ratio < least_log_ratio * count || left < least_residual * count) {
        return {};
    }
    return {
        {SetupFault::wrong_robot, Severity::mistake, listed(columns),
         "columns " + listed(columns) +
             ": expected the outputs of the robot's model, found that the model with any payload leaves " +
             percent(left / count) + " of their variance, and smooth functions of the motion " +
             percent(left / count * std::exp(-ratio / count)) +
             ": another robot, tip, base, mounting or zeros of joints; give the file of this robot "
             "(--robot)"}};
}

} // namespace dfdyn::tools
