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
#include <iterator>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double share_of_median_least = 1.0 / 3;
constexpr double share_of_median_most = 3;
constexpr double least_gain = 1e-4; // A/N·m, below those of the largest geared drives
constexpr double largest_gain = 1e4;

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

double gain_of(const Eigen::VectorXd& current, const Eigen::VectorXd& torque, const Eigen::VectorXd& velocity,
               double sign_velocity) {
    Eigen::MatrixXd columns(current.size(), 4);
    columns << torque, velocity, friction_direction(velocity, sign_velocity),
        Eigen::VectorXd::Ones(current.size());
    return least_squares(columns, current)[0];
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
                                     const std::function<RecordedMotion()>& recorded, double sign_velocity) {
    if (outputs != OutputKind::motor_current) {
        return {};
    }
    if (constants.empty()) {
        return estimate_torque_gains(robot, recorded(), sign_velocity);
    }
    check_torque_constants(constants, outputs, robot.joints.size());
    std::vector<TorqueGain> gains;
    for (const double constant : constants) {
        gains.push_back({1 / constant, TorqueGain::Source::given});
    }
    return gains;
}

std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const RecordedMotion& recorded,
                                              double sign_velocity) {
    const RobotMotion& motion = recorded.motion;
    const Eigen::MatrixXd torques = nominal_torques(robot, motion);
    std::vector<double> found;
    for (Eigen::Index i = 0; i < torques.cols(); ++i) {
        found.push_back(
            gain_of(recorded.outputs.col(i), torques.col(i), motion.velocity.col(i), sign_velocity));
    }
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
