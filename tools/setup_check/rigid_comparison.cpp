// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/rigid_comparison.hpp"

#include "tools/base/recording/stretches.hpp"
#include "tools/robot/dynamics/friction_direction.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"
#include "tools/robot/regressor.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double row_step_s = 0.01;
constexpr double half_window_s = 0.06; ///< of the derivatives
constexpr Index most_rows = 1000;
constexpr Index fewest_rows = 100;
constexpr double least_travel = 0.1; ///< rad (m)

Columns every_row(const Columns& columns, std::size_t stride, std::size_t rows) {
    Columns result{columns.names, {}};
    for (std::size_t row = 0; columns.present() && row < rows; row += stride) {
        const auto values = columns.row(row);
        result.values.insert(result.values.end(), values.begin(), values.end());
    }
    return result;
}

/// Returns every `stride`-th row, positions and outputs only. A gap between two of these rows is preserved.
Recording thinned(const Recording& recording, std::size_t stride) {
    const std::size_t rows = recording.row_count();
    Recording result;
    result.source = recording.source;
    result.position = every_row(recording.position, stride, rows);
    result.output = every_row(recording.output, stride, rows);
    for (std::size_t row = 0; row < rows; row += stride) {
        result.time_s.push_back(recording.time_s[row]);
        result.time_ns.push_back(recording.time_ns[row]);
        const auto first =
            recording.gap_before.begin() + static_cast<std::ptrdiff_t>(row < stride ? row : row - stride + 1);
        const auto last = recording.gap_before.begin() + static_cast<std::ptrdiff_t>(row) + 1;
        result.gap_before.push_back(std::any_of(first, last, [](auto gap) { return gap != 0; }) ? 1 : 0);
    }
    return result;
}

/// Sets rounding errors to zero, so that they are not taken for a signal.
MatrixXd without_rounding(const MatrixXd& part, double largest) {
    return (part.array().abs() > 1e-9 * largest).select(part, 0);
}

} // namespace

std::optional<CheckedMotion> checked_motion(const Recording& recording) {
    if (recording.row_count() < static_cast<std::size_t>(fewest_rows)) {
        return std::nullopt;
    }
    const double step_s = median_step_s(recording);
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(row_step_s / step_s)));
    const int half_width = static_cast<int>(
        std::clamp(std::round(half_window_s / (step_s * static_cast<double>(stride))), 2.0, 6.0));
    const SampledMotion sampled = sampled_motion(thinned(recording, stride), {half_width, 3});
    std::vector<Index> valid;
    for (std::size_t row = 0; row < sampled.valid.size(); ++row) {
        if (sampled.valid[row] != 0) {
            valid.push_back(static_cast<Index>(row));
        }
    }
    const Index rows = std::ssize(valid);
    if (rows < fewest_rows) {
        return std::nullopt;
    }
    const Index count = std::min(rows, most_rows);
    CheckedMotion result;
    std::vector<Index> kept;
    for (Index i = 0; i < count; ++i) {
        kept.push_back(valid[static_cast<std::size_t>((2 * i + 1) * rows / (2 * count))]);
        result.rows.push_back(static_cast<std::size_t>(kept.back()) * stride);
    }
    const RobotMotion& motion = sampled.all.motion;
    result.recorded = {{motion.position(kept, Eigen::all), motion.velocity(kept, Eigen::all),
                        motion.acceleration(kept, Eigen::all)},
                       sampled.all.outputs(kept, Eigen::all)};
    return result;
}

namespace {

/// 35 % of the arm's mass; for a light arm 6 kg, but not more than its own mass.
double heaviest_payload(const Robot& robot) {
    constexpr double share = 0.35;
    constexpr double of_light_arm_kg = 6;
    double mass = 0;
    for (const RobotJoint& joint : robot.joints) {
        mass += joint.inertia[0];
    }
    return std::max(share * mass, std::min(of_light_arm_kg, mass));
}

/// `regressor`: of the last link along the motion, stacked, 10 columns. The payloads differ in their first
/// moments only, so that a sum with nonnegative factors is a payload between the corners. Their moments of
/// inertia are those of a point mass at the tip; the free factor of the arm's inertia covers larger ones.
std::vector<MatrixXd> loaded_outputs(const Robot& robot, const MatrixXd& gravity, const MatrixXd& regressor) {
    constexpr double reach = 0.15; // m, along each axis of the last link
    const double mass = heaviest_payload(robot);
    const Eigen::Vector3d tip = robot.tip_placement.translation();
    InertialParameters payload = body_parameters(mass, tip, Eigen::Matrix3d::Zero());
    std::vector<MatrixXd> result;
    for (const double x : {-reach, reach}) {
        for (const double y : {-reach, reach}) {
            for (const double z : {-reach, reach}) {
                payload.segment<3>(1) = mass * (tip + Eigen::Vector3d(x, y, z));
                result.push_back(gravity + unstacked(regressor * payload, gravity.cols()));
            }
        }
    }
    return result;
}

} // namespace

RigidParts rigid_parts(const Robot& robot, OutputKind kind, const RobotMotion& motion) {
    RobotMotion stationary = motion;
    stationary.velocity.setZero();
    stationary.acceleration.setZero();
    const VectorXd nominal = nominal_parameters(robot, kind);
    const MatrixXd regressor = stacked_regressor(robot, kind, motion);
    const VectorXd at_rest = stacked_regressor(robot, kind, stationary) * nominal;
    const MatrixXd gravity = unstacked(at_rest, at_rest.size() / motion.rows());
    const MatrixXd inertia = unstacked(regressor * nominal, gravity.cols()) - gravity;
    const double largest = std::max(gravity.cwiseAbs().maxCoeff(), inertia.cwiseAbs().maxCoeff());
    RigidParts parts{without_rounding(gravity, largest), without_rounding(inertia, largest), {}};
    if (kind != OutputKind::wrench) {
        parts.loaded = loaded_outputs(robot, parts.gravity, regressor.rightCols<10>());
        for (MatrixXd& loaded : parts.loaded) {
            loaded = without_rounding(loaded, largest);
        }
    }
    return parts;
}

VectorXd deviations(const MatrixXd& columns) {
    return (columns.rowwise() - columns.colwise().mean()).colwise().norm();
}

VectorXd friction_direction(const VectorXd& velocity) {
    const double turning = std::max(2e-3, 0.03 * velocity.cwiseAbs().maxCoeff());
    return friction_direction(velocity, turning);
}

MatrixXd friction_columns(const RobotMotion& motion, Index joint) {
    MatrixXd columns(motion.rows(), 2);
    columns << motion.velocity.col(joint), friction_direction(motion.velocity.col(joint));
    return columns;
}

bool swings(const RobotMotion& motion, Index joint, int turns) {
    const auto position = motion.position.col(joint);
    const VectorXd velocity = motion.velocity.col(joint);
    const double moving = 0.1 * velocity.cwiseAbs().maxCoeff();
    int found = 0;
    double direction = 0;
    for (const double speed : velocity) {
        if (std::abs(speed) > moving) {
            found += direction * speed < 0 ? 1 : 0;
            direction = speed;
        }
    }
    return position.maxCoeff() - position.minCoeff() >= least_travel && found >= turns;
}

MatrixXd smooth_columns(const RobotMotion& motion) {
    const Index joints = motion.position.cols();
    std::vector<VectorXd> columns;
    for (Index joint = 0; joint < joints; ++joint) {
        VectorXd angle = VectorXd::Zero(motion.rows());
        for (Index last = joint; last < std::min(joint + 3, joints); ++last) {
            angle += motion.position.col(last);
            columns.emplace_back(angle.array().sin());
            columns.emplace_back(angle.array().cos());
        }
        columns.emplace_back(motion.position.col(joint));
        columns.emplace_back(motion.acceleration.col(joint));
    }
    MatrixXd result(motion.rows(), static_cast<Index>(columns.size()));
    for (std::size_t column = 0; column < columns.size(); ++column) {
        result.col(static_cast<Index>(column)) = columns[column];
    }
    return result;
}

namespace {

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

} // namespace

FrictionSign friction_sign(const RecordedMotion& recorded, Index joint) {
    constexpr double clearly = 0.6;
    constexpr double least_share = 0.01;
    if (!swings(recorded.motion, joint, certain_turns)) {
        return FrictionSign::unclear;
    }
    const MatrixXd smooth = smooth_columns(recorded.motion);
    const MatrixXd friction = friction_columns(recorded.motion, joint);
    const VectorXd output = recorded.outputs.col(joint);
    const double braking = fit_signed(output, smooth, friction).left;
    const double driving = fit_signed(output, smooth, -friction).left;
    if (!(std::min(braking, driving) < clearly * std::max(braking, driving)) ||
        std::abs(braking - driving) < least_share) {
        return FrictionSign::unclear;
    }
    const MatrixXd left =
        left_of_columns((MatrixXd(output.size(), 2) << output, friction.col(1)).finished(), smooth);
    if (!parts_agree(left.col(0), left.col(1), braking < driving ? 1 : -1)) {
        return FrictionSign::unclear;
    }
    return braking < driving ? FrictionSign::brakes : FrictionSign::drives;
}

MatrixXd expected_columns(const ArmRecording& arm, const RobotMotion& motion, const RigidParts& parts,
                          Index k) {
    if (arm.wrench()) {
        return parts.sum(k);
    }
    const auto loads = std::ssize(parts.loaded);
    MatrixXd columns(motion.rows(), 4 + loads);
    columns.leftCols<4>() << parts.gravity.col(k), parts.inertia.col(k), friction_columns(motion, k);
    for (Index load = 0; load < loads; ++load) {
        columns.col(4 + load) = parts.loaded[static_cast<std::size_t>(load)].col(k);
    }
    return columns;
}

double left_by(const VectorXd& output, const MatrixXd& columns) {
    return fit_signed(output, MatrixXd(output.size(), 0), columns).left;
}

} // namespace dfdyn::tools
