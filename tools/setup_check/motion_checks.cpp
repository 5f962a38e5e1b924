// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/friction_sign.hpp"
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns of sines and cosines of the angles, of their sums and differences, and of accelerations and
/// friction.
MatrixXd gravity_columns(const RobotMotion& motion, double radians_per_unit) {
    const MatrixXd angle = radians_per_unit * motion.position;
    std::vector<VectorXd> angles;
    for (Index joint = 0; joint < angle.cols(); ++joint) {
        angles.emplace_back(angle.col(joint));
    }
    if (angle.cols() == 2) {
        angles.emplace_back(angle.col(0) + angle.col(1));
        angles.emplace_back(angle.col(0) - angle.col(1));
    }
    const Index joints = angle.cols();
    MatrixXd columns(motion.rows(), 2 * static_cast<Index>(angles.size()) + 3 * joints);
    Index next = 0;
    for (const VectorXd& one : angles) {
        columns.col(next++) = one.array().sin();
        columns.col(next++) = one.array().cos();
    }
    for (Index joint = 0; joint < joints; ++joint) {
        columns.col(next++) = motion.acceleration.col(joint);
        columns.col(next++) = motion.velocity.col(joint);
        columns.col(next++) = friction_direction(motion.velocity.col(joint));
    }
    return columns;
}

double mean_left(const RecordedMotion& recorded, const MatrixXd& columns) {
    double left = 0;
    for (Index output = 0; output < recorded.outputs.cols(); ++output) {
        left += fit_signed(recorded.outputs.col(output), columns, MatrixXd(columns.rows(), 0)).left;
    }
    return left / static_cast<double>(recorded.outputs.cols());
}

} // namespace

SetupFindings check_friction_sign(const Recording& recording, const RecordedMotion& recorded,
                                  OutputKind outputs) {
    SetupFindings findings;
    if (outputs == OutputKind::wrench) {
        return findings; // no output is that of a joint
    }
    for (Index joint = 0; joint < recorded.outputs.cols(); ++joint) {
        const FrictionEvidence friction = friction_sign(recorded, joint);
        if (friction.sign == FrictionSign::drives) {
            const auto index = static_cast<std::size_t>(joint);
            findings.push_back(
                {SetupFault::torque_sign, friction.certain ? Severity::mistake : Severity::warning,
                 recording.position.names[index] + ", " + recording.output.names[index],
                 "columns " + recording.position.names[index] + " and " + recording.output.names[index] +
                     ": expected an output that overcomes the joint's friction, found one that "
                     "falls when the joint begins to move: multiply one of the two by -1, or "
                     "see whether they are columns of two joints"});
        }
    }
    return findings;
}

SetupFindings check_degrees_by_gravity(const Recording& recording, const RecordedMotion& recorded) {
    const MatrixXd& position = recorded.motion.position;
    if (position.cols() > 2 || !(position.cwiseAbs().maxCoeff() > 4 * std::numbers::pi)) {
        return {};
    }
    const double radians = mean_left(recorded, gravity_columns(recorded.motion, 1));
    const double degrees = mean_left(recorded, gravity_columns(recorded.motion, std::numbers::pi / 180));
    if (!(degrees < 0.5 * radians)) {
        return {};
    }
    return {{SetupFault::position_unit, Severity::mistake, listed(recording.position.names),
             "columns " + listed(recording.position.names) + ": expected rad, found up to " +
                 rounded_text(position.cwiseAbs().maxCoeff()) + ": looks like degrees (" + percent(degrees) +
                 " of the outputs' variance left instead of " + percent(radians) + "); " +
                 unit_remedy("q", "deg")}};
}

} // namespace dfdyn::tools
