// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/torque_gains.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/robot/dynamics/friction_direction.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr double share_of_median_least = 1.0 / 3;
constexpr double share_of_median_most = 3;
constexpr double least_gain = 1e-4; // A/N·m, below those of the largest geared drives
constexpr double largest_gain = 1e4;
constexpr Eigen::Index jackknife_blocks = 8;
constexpr std::size_t least_moving_rows = 40;
constexpr double largest_deviation = 0.1;     // of a determined gain
constexpr double least_share_of_torque = 0.2; // less is as small as the errors of a robot file's masses
constexpr Eigen::Index velocity_column = 1;   // of current_rows()
constexpr Eigen::Index acceleration_column = 4;

/// Returns the torques of the nominal rigid body, T x n.
Eigen::MatrixXd nominal_torques(const Robot& robot, const RobotMotion& motion) {
    constexpr Eigen::Index rows_at_once = 256; // so that memory does not grow with T
    const Eigen::VectorXd parameters = nominal_parameters(robot, OutputKind::joint_torque);
    const Eigen::Index joints = motion.position.cols();
    Eigen::MatrixXd torques(motion.rows(), joints);
    for (Eigen::Index first = 0; first < motion.rows(); first += rows_at_once) {
        const Eigen::Index rows = std::min(rows_at_once, motion.rows() - first);
        const RobotMotion part{motion.position.middleRows(first, rows),
                               motion.velocity.middleRows(first, rows),
                               motion.acceleration.middleRows(first, rows)};
        const Eigen::VectorXd stacked_torques =
            stacked_regressor(robot, OutputKind::joint_torque, part) * parameters;
        torques.middleRows(first, rows) = unstacked(stacked_torques, joints);
    }
    return torques;
}

/// Returns T x 6: torque, velocity, direction of friction, 1, acceleration, and the current that they
/// compose.
Eigen::MatrixXd current_rows(const RecordedMotion& recorded, const Eigen::MatrixXd& torques,
                             Eigen::Index joint, double sign_velocity) {
    const Eigen::VectorXd velocity = recorded.motion.velocity.col(joint);
    Eigen::MatrixXd rows(velocity.size(), 6);
    rows << torques.col(joint), velocity, friction_direction(velocity, sign_velocity),
        Eigen::VectorXd::Ones(velocity.size()), recorded.motion.acceleration.col(joint),
        recorded.outputs.col(joint);
    return rows;
}

/// Returns the factor of the first column, the torque, in the last one, the current.
double gain_of(const Eigen::MatrixXd& rows) {
    const Eigen::Index columns = rows.cols() - 1;
    return least_squares(rows.leftCols(columns), Eigen::VectorXd(rows.col(columns)))[0];
}

struct EstimatedGain {
    double gain = 0;
    double deviation = 0; ///< standard deviation
};

/// The deviation is that of the jackknife over blocks of time, which needs no model of the errors'
/// correlation.
EstimatedGain gain_with_deviation(const Eigen::MatrixXd& rows) {
    const Eigen::Index size = rows.cols();
    Eigen::MatrixXd blocks = Eigen::MatrixXd::Zero(jackknife_blocks * size, size);
    for (Eigen::Index block = 0; block < jackknife_blocks; ++block) {
        const Eigen::Index first = rows.rows() * block / jackknife_blocks;
        const Eigen::Index end = rows.rows() * (block + 1) / jackknife_blocks;
        const Eigen::MatrixXd factor = triangular_factor(rows.middleRows(first, end - first));
        blocks.middleRows(block * size, factor.rows()) = factor;
    }
    Eigen::VectorXd without(jackknife_blocks);
    for (Eigen::Index block = 0; block < jackknife_blocks; ++block) {
        Eigen::MatrixXd others = blocks;
        others.middleRows(block * size, size).setZero();
        without[block] = gain_of(others);
    }
    const double share = static_cast<double>(jackknife_blocks - 1) / static_cast<double>(jackknife_blocks);
    return {gain_of(blocks), std::sqrt(share * (without.array() - without.mean()).square().sum())};
}

/// Returns the share of the torque in the spread of the current.
double share_of_torque(const Eigen::MatrixXd& rows, double gain) {
    const auto spread = [&](Eigen::Index column) {
        return (rows.col(column).array() - rows.col(column).mean()).matrix().norm();
    };
    return gain * spread(0) / spread(rows.cols() - 1);
}

/// Returns the gain from the rows in which the joint moves, and 0 if they do not determine it. At rest,
/// friction bears an unknown part of the weight.
double determined_gain(const Eigen::MatrixXd& rows, double sign_velocity) {
    std::vector<Eigen::Index> moving;
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
        if (std::abs(rows(row, velocity_column)) > sign_velocity) {
            moving.push_back(row);
        }
    }
    if (moving.size() < least_moving_rows) {
        return 0;
    }
    const Eigen::MatrixXd in_motion = rows(moving, Eigen::all);
    const EstimatedGain estimated = gain_with_deviation(in_motion);
    const bool determined = estimated.deviation < largest_deviation * estimated.gain &&
                            share_of_torque(in_motion, estimated.gain) > least_share_of_torque;
    return determined ? estimated.gain : 0;
}

/// Returns the gain from all rows, without a rotor's inertia.
double possible_gain(const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd columns(rows.rows(), acceleration_column + 1);
    columns << rows.leftCols(acceleration_column), rows.rightCols(1);
    return gain_of(columns);
}

/// Returns `gain(current_rows)` of each joint.
template <class Gain>
std::vector<double> gains_of_joints(const Robot& robot, const RecordedMotion& recorded, double sign_velocity,
                                    Gain gain) {
    const Eigen::MatrixXd torques = nominal_torques(robot, recorded.motion);
    std::vector<double> gains;
    for (Eigen::Index joint = 0; joint < torques.cols(); ++joint) {
        gains.push_back(gain(current_rows(recorded, torques, joint, sign_velocity)));
    }
    return gains;
}

/// Replaces gains that are not plausible beside the others by the median of the positive ones.
std::vector<TorqueGain> with_median(std::span<const double> found) {
    std::vector<double> positive;
    std::ranges::copy_if(found, std::back_inserter(positive), [](double gain) { return gain > 0; });
    const double middle = positive.empty() ? 1 : median(std::move(positive));
    std::vector<TorqueGain> gains;
    for (const double gain : found) {
        const bool plausible = gain > share_of_median_least * middle && gain < share_of_median_most * middle;
        gains.push_back(plausible ? TorqueGain{gain, TorqueGain::Source::estimated}
                                  : TorqueGain{middle, TorqueGain::Source::median});
    }
    return gains;
}

} // namespace

void check_torque_constants(std::span<const double> constants, OutputKind outputs, std::size_t joints) {
    if (constants.empty()) {
        return;
    }
    if (outputs != OutputKind::motor_current) {
        throw InputError(std::string("--torque-constants: expected with --outputs i, found with --outputs ") +
                         (outputs == OutputKind::wrench ? "wrench" : "tau"));
    }
    if (constants.size() != joints) {
        throw InputError("--torque-constants: expected " + std::to_string(joints) +
                         ", one per joint, found " + std::to_string(constants.size()));
    }
    for (const double constant : constants) {
        if (!(constant > 0)) {
            throw InputError("--torque-constants: expected positive numbers, found " + number_text(constant));
        }
    }
}

std::vector<TorqueGain> torque_gains(const Robot& robot, OutputKind outputs,
                                     std::span<const double> constants,
                                     const std::function<std::vector<TorqueGain>()>& estimate) {
    if (outputs != OutputKind::motor_current) {
        return {};
    }
    if (constants.empty()) {
        return estimate();
    }
    check_torque_constants(constants, outputs, robot.joints.size());
    std::vector<TorqueGain> gains;
    for (const double constant : constants) {
        gains.push_back({1 / constant, TorqueGain::Source::given});
    }
    return gains;
}

std::vector<TorqueGain> rough_torque_gains(const Robot& robot, const RecordedMotion& recorded,
                                           double sign_velocity) {
    return with_median(gains_of_joints(robot, recorded, sign_velocity, possible_gain));
}

std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const RecordedMotion& recorded,
                                              double sign_velocity) {
    const std::vector<double> found =
        gains_of_joints(robot, recorded, sign_velocity, [sign_velocity](const Eigen::MatrixXd& rows) {
            return determined_gain(rows, sign_velocity);
        });
    return std::ranges::any_of(found, [](double gain) { return gain > 0; })
               ? with_median(found)
               : rough_torque_gains(robot, recorded, sign_velocity);
}

void check_estimated_gains(std::span<const TorqueGain> gains) {
    const auto plausible = [](const TorqueGain& one) {
        return one.source == TorqueGain::Source::given ||
               (one.gain >= least_gain && one.gain <= largest_gain);
    };
    if (std::ranges::all_of(gains, plausible)) {
        return;
    }
    std::vector<std::string> found;
    for (const TorqueGain& one : gains) {
        found.push_back(formatted("%.5g", 1 / one.gain));
    }
    throw InputError("torque constants estimated with the robot's masses: expected " +
                     formatted("%.5g", 1 / largest_gain) + " to " + formatted("%.5g", 1 / least_gain) +
                     " N m/A, found " + listed(found) +
                     ": check the robot and the unit of the currents (--units i=mA), or give "
                     "--torque-constants");
}

std::vector<double> output_gains(std::span<const TorqueGain> gains, std::size_t outputs) {
    std::vector<double> result(outputs, 1);
    std::ranges::transform(gains, result.begin(), &TorqueGain::gain);
    return result;
}

} // namespace dfdyn::tools
