// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"

#include "tools/base/recording/stretches.hpp"
#include "tools/robot/dynamics/friction_direction.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"
#include "tools/robot/regressor.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

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

/// Rows of which the derivatives are computed.
struct DerivativeRows {
    std::size_t stride; ///< every so many rows of the recording
    int half_width;     ///< rows before and after
    double step_s;      ///< between them
};

DerivativeRows derivative_rows(const Recording& recording) {
    const double step_s = median_step_s(recording);
    const double stride = std::max(1.0, std::round(row_step_s / step_s));
    const double half_width = std::clamp(std::round(half_window_s / (step_s * stride)), 2.0, 6.0);
    return {static_cast<std::size_t>(stride), static_cast<int>(half_width), step_s * stride};
}

/// Gravity of a vertical axis in a robot's file with angles of few digits, relative to the largest output.
constexpr double rounded_tilt = 1e-4;

/// Sets rounding errors to zero, so that they are not taken for a signal.
MatrixXd without_rounding(const MatrixXd& part, double largest) {
    return (part.array().abs() > 1e-9 * largest).select(part, 0);
}

} // namespace

std::optional<CheckedMotion> checked_motion(const Recording& recording) {
    if (recording.row_count() < static_cast<std::size_t>(fewest_rows)) {
        return std::nullopt;
    }
    const auto [stride, half_width, step_s] = derivative_rows(recording);
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

double acceleration_noise(const Recording& recording, Index joint) {
    const auto [stride, half_width, step_s] = derivative_rows(recording);
    const auto column = static_cast<std::size_t>(joint);
    double sum = 0;
    double count = 0;
    for (std::size_t row = 4; row < recording.row_count(); ++row) {
        const auto first = recording.gap_before.begin() + static_cast<std::ptrdiff_t>(row) - 3;
        if (std::all_of(first, first + 4, [](auto gap) { return gap == 0; })) {
            const auto q = [&](std::size_t back) { return recording.position.row(row - back)[column]; };
            const double difference = q(0) - 4 * q(1) + 6 * q(2) - 4 * q(3) + q(4);
            sum += difference * difference;
            count += 1;
        }
    }
    constexpr double gain = 70; // of the variance, in a fourth difference
    const double position_variance = sum / (gain * std::max(count, 1.0));
    const double points = 2 * half_width + 1;
    const double squares = points * (points * points - 1) * (points * points - 4) / 180;
    return 2 * std::sqrt(position_variance / squares) / (step_s * step_s);
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
    for (Index k = 0; k < gravity.cols(); ++k) {
        if (gravity.col(k).cwiseAbs().maxCoeff() < rounded_tilt * largest) {
            parts.gravity.col(k).setZero();
        }
    }
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

bool travels(const RobotMotion& motion, Index joint) {
    const auto position = motion.position.col(joint);
    return position.maxCoeff() - position.minCoeff() >= least_travel;
}

/// Number of reversals from a tenth of the largest speed to the opposite.
int velocity_turns(const VectorXd& velocity) {
    const double moving = 0.1 * velocity.cwiseAbs().maxCoeff();
    int found = 0;
    double direction = 0;
    for (const double speed : velocity) {
        if (std::abs(speed) > moving) {
            found += direction * speed < 0 ? 1 : 0;
            direction = speed;
        }
    }
    return found;
}

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
    return travels(motion, joint) && velocity_turns(motion.velocity.col(joint)) >= turns &&
           position_turns(motion.position.col(joint)) >= turns;
}

std::vector<Index> moving_rows(const RobotMotion& motion) {
    Eigen::Array<bool, Eigen::Dynamic, 1> moves = Eigen::Array<bool, Eigen::Dynamic, 1>::Zero(motion.rows());
    for (Index joint = 0; joint < motion.position.cols(); ++joint) {
        if (travels(motion, joint)) {
            const VectorXd velocity = motion.velocity.col(joint);
            moves = moves || velocity.array().abs() > turning_speed(velocity);
        }
    }
    const bool stationary = !moves.any();
    std::vector<Index> rows;
    for (Index row = 0; row < moves.size(); ++row) {
        if (stationary || moves[row]) {
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
