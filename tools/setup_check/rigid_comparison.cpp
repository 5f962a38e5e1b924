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

/// `regressor`: of the last link along the motion, stacked, 10 columns. A sum with nonnegative factors is a
/// payload with its centre between the corners, and with a moment of inertia between those of a point mass at
/// the tip and of masses at the corners.
std::vector<MatrixXd> loaded_outputs(const Robot& robot, const MatrixXd& gravity, const MatrixXd& regressor) {
    constexpr double reach = 0.2; // m, along each axis of the last link
    const double mass = heaviest_payload(robot);
    const Eigen::Vector3d tip = robot.tip_placement.translation();
    const InertialParameters at_tip = body_parameters(mass, tip, Eigen::Matrix3d::Zero());
    std::vector<MatrixXd> result;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d away((corner & 1) == 0 ? -reach : reach, (corner & 2) == 0 ? -reach : reach,
                                   (corner & 4) == 0 ? -reach : reach);
        InertialParameters payload = body_parameters(mass, tip + away, Eigen::Matrix3d::Zero());
        result.push_back(gravity + unstacked(regressor * payload, gravity.cols()));
        payload.tail<6>() = at_tip.tail<6>();
        result.push_back(gravity + unstacked(regressor * payload, gravity.cols()));
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

namespace {

/// Speed from which on the direction of Coulomb friction is that of the velocity, rad/s (m/s).
double turning_speed(const VectorXd& velocity) {
    return std::max(2e-3, 0.03 * velocity.cwiseAbs().maxCoeff());
}

} // namespace

VectorXd friction_direction(const VectorXd& velocity) {
    return friction_direction(velocity, turning_speed(velocity));
}

MatrixXd friction_columns(const RobotMotion& motion, Index joint) {
    MatrixXd columns(motion.rows(), 2);
    columns << motion.velocity.col(joint), friction_direction(motion.velocity.col(joint));
    return columns;
}

namespace {

/// Number of reversals after which a joint moves back by a tenth of the least travel. At a low speed the
/// noise of the positions reverses the velocity.
int position_turns(const VectorXd& position) {
    int found = 0;
    double direction = 0;
    double extreme = position[0];
    for (const double one : position) {
        if (direction * (one - extreme) > 0) {
            extreme = one;
        } else if (std::abs(one - extreme) > 0.1 * least_travel) {
            found += direction != 0 ? 1 : 0;
            direction = one - extreme;
            extreme = one;
        }
    }
    return found;
}

} // namespace

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
    return position.maxCoeff() - position.minCoeff() >= least_travel &&
           std::min(found, position_turns(position)) >= turns;
}

std::vector<Index> moving_rows(const RobotMotion& motion) {
    Eigen::Array<bool, Eigen::Dynamic, 1> moves = Eigen::Array<bool, Eigen::Dynamic, 1>::Zero(motion.rows());
    for (Index joint = 0; joint < motion.position.cols(); ++joint) {
        const auto position = motion.position.col(joint);
        if (position.maxCoeff() - position.minCoeff() >= least_travel) {
            const VectorXd velocity = motion.velocity.col(joint);
            moves = moves || velocity.array().abs() > turning_speed(velocity);
        }
    }
    std::vector<Index> rows;
    for (Index row = 0; row < moves.size(); ++row) {
        if (moves[row] || !moves.any()) {
            rows.push_back(row);
        }
    }
    return rows;
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

/// Returns whether the step of Coulomb friction at the reversals has this sign, in addition to a viscous
/// friction of any sign. Inertia of other joints, which the smooth functions lack, can look like the velocity
/// of a joint with few reversals, but is continuous at these.
bool steps(const VectorXd& output, const MatrixXd& smooth, const MatrixXd& friction, double sign) {
    constexpr double clearly = 0.95; // simulated runs without friction that looked reversed: 0.96 and more
    const MatrixXd free = (MatrixXd(smooth.rows(), smooth.cols() + 1) << smooth, friction.col(0)).finished();
    return fit_signed(output, free, sign * friction.col(1)).left <
           clearly * fit_signed(output, free, -sign * friction.col(1)).left;
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
    const double sign = braking < driving ? 1 : -1;
    const MatrixXd left =
        left_of_columns((MatrixXd(output.size(), 2) << output, friction.col(1)).finished(), smooth);
    if (!parts_agree(left.col(0), left.col(1), sign) || !steps(output, smooth, friction, sign)) {
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
