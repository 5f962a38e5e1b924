// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/friction_sign.hpp"

#include "tools/setup_check/rigid_body/rigid_comparison.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns whether all but one of the parts with visible friction, at least five, have this sign.
bool parts_agree(const VectorXd& output, const VectorXd& direction, double sign) {
    constexpr Index parts = 8;
    constexpr int fewest = 5;
    const Index rows = output.size() / parts;
    int shown = 0;
    int agree = 0;
    for (Index part = 0; part < parts; ++part) {
        const auto segment = direction.segment(part * rows, rows);
        if (segment.squaredNorm() * parts > 0.1 * direction.squaredNorm()) {
            ++shown;
            agree += sign * segment.dot(output.segment(part * rows, rows)) > 0 ? 1 : 0;
        }
    }
    return shown >= fewest && agree >= shown - 1;
}

/// Residual shares of an output beside `free` columns, for friction that brakes and that drives.
struct BothSigns {
    double braking = 1, driving = 1;

    double sign() const { return braking < driving ? 1 : -1; }
    bool clear() const {
        constexpr double clearly = 0.6;
        constexpr double least_share = 0.01;
        return std::min(braking, driving) < clearly * std::max(braking, driving) &&
               std::abs(braking - driving) >= least_share;
    }
};

BothSigns compare(const VectorXd& output, const MatrixXd& free, const MatrixXd& friction) {
    return {fit_signed(output, free, friction).left, fit_signed(output, free, -friction).left};
}

MatrixXd joined(const MatrixXd& left, const MatrixXd& right) {
    MatrixXd columns(left.rows(), left.cols() + right.cols());
    columns << left, right;
    return columns;
}

/// Products of all velocities, T x n (n + 1) / 2.
MatrixXd velocity_products(const MatrixXd& velocity) {
    const Index joints = velocity.cols();
    MatrixXd columns(velocity.rows(), joints * (joints + 1) / 2);
    Index next = 0;
    for (Index one = 0; one < joints; ++one) {
        for (Index other = one; other < joints; ++other) {
            columns.col(next++) = velocity.col(one).cwiseProduct(velocity.col(other));
        }
    }
    return columns;
}

/// Returns whether the step of Coulomb friction at the reversals has this sign, in addition to a viscous
/// friction of any sign. Inertia of other joints, which the smooth functions lack, can look like the velocity
/// of a joint with few reversals, but is continuous at these.
bool steps(const VectorXd& output, const MatrixXd& smooth, const MatrixXd& friction, double sign) {
    constexpr double clearly = 0.95; // simulated runs without friction that looked reversed: 0.96 and more
    const BothSigns step = compare(output, joined(smooth, friction.col(0)), sign * friction.col(1));
    return step.braking < clearly * step.driving;
}

/// Returns whether the sign is also clear beside the torques of several moving joints' velocities.
bool certain(const VectorXd& output, const MatrixXd& smooth, const RecordedMotion& recorded,
             const MatrixXd& friction, double sign) {
    const MatrixXd free = joined(smooth, velocity_products(recorded.motion.velocity));
    if (2 * free.cols() > free.rows()) {
        return false; // so many functions explain any output
    }
    const BothSigns beside = compare(output, free, friction);
    return beside.clear() && beside.sign() == sign;
}

} // namespace

FrictionEvidence friction_sign(const RecordedMotion& recorded, Index joint) {
    if (!swings(recorded.motion, joint, certain_turns)) {
        return {};
    }
    const MatrixXd smooth = smooth_columns(recorded.motion);
    const MatrixXd friction = friction_columns(recorded.motion, joint);
    const VectorXd output = recorded.outputs.col(joint);
    const BothSigns found = compare(output, smooth, friction);
    if (!found.clear()) {
        return {};
    }
    const double sign = found.sign();
    const MatrixXd left = left_of_columns(joined(output, friction.col(1)), smooth);
    if (!parts_agree(left.col(0), left.col(1), sign) || !steps(output, smooth, friction, sign)) {
        return {};
    }
    return {sign > 0 ? FrictionSign::brakes : FrictionSign::drives,
            certain(output, smooth, recorded, friction, sign)};
}

} // namespace dfdyn::tools
