// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/robot_match.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rows in which a joint moves. A standing joint's friction may hold any torque up to its break-away torque,
/// one for each posture, and smooth functions of a few postures describe that, too.
std::vector<Index> moving_rows(const RobotMotion& motion, Index joint) {
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

/// Returns the share of its degrees of freedom that a fit of `columns` leaves. Of rows 10 ms apart every
/// other one counts, because their derivatives share most of a window.
double free_share(std::size_t rows, Index columns) {
    return 1 - 2 * static_cast<double>(columns) / static_cast<double>(std::max<std::size_t>(rows, 1));
}

VectorXd deviations(const MatrixXd& columns) {
    return (columns.rowwise() - columns.colwise().mean()).colwise().norm();
}

} // namespace

SetupFindings check_robot_match(const ArmRecording& arm) {
    constexpr double carries = 0.1; // of the largest deviation of gravity
    constexpr double least_share = 0.01;
    constexpr double far_better = 1.2;
    constexpr double much = 0.06;
    constexpr int turns = 2;
    constexpr double least_free = 0.5; // with fewer rows so many functions fit anything
    const RobotMotion& motion = arm.recorded.motion;
    if (arm.wrench()) {
        return {};
    }
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, motion);
    const VectorXd weight = deviations(parts.gravity);
    const MatrixXd smooth = smooth_columns(motion);
    std::vector<std::string> columns;
    double ratio = 0;
    double left = 0;
    for (Index k = 0; k < arm.counted(); ++k) {
        if (!(weight[k] > carries * weight.maxCoeff()) || !swings(motion, k, turns)) {
            continue;
        }
        const std::vector<Index> rows = moving_rows(motion, k);
        const double free = free_share(rows.size(), smooth.cols());
        if (free < least_free) {
            continue;
        }
        const VectorXd output = arm.output(k)(rows);
        const double by_robot = left_by(output, expected_columns(arm, motion, parts, k)(rows, Eigen::all));
        const double by_any =
            fit_signed(output, smooth(rows, Eigen::all), friction_columns(motion, k)(rows, Eigen::all)).left /
            free;
        ratio += std::log(std::max(by_robot, least_share) / std::max(by_any, least_share));
        left += by_robot;
        columns.push_back(arm.recording.output.names[static_cast<std::size_t>(k)]);
    }
    const auto count = static_cast<double>(columns.size());
    if (columns.empty() || ratio < far_better * count || left < much * count) {
        return {};
    }
    return {{SetupFault::wrong_robot, Severity::mistake, listed(columns),
             "columns " + listed(columns) +
                 ": expected the outputs of the robot's model, found that it leaves " +
                 percent(left / count) +
                 " of their variance, any payload included, and smooth functions of the motion " +
                 percent(left / count * std::exp(-ratio / count)) +
                 ": another robot, tip, base, mounting or zeros of joints; give the file of this robot "
                 "(--robot)"}};
}

} // namespace dfdyn::tools
