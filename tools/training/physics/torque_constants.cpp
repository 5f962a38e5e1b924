// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/torque_constants.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/training/physics/robot_regressor.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double share_of_median_least = 1.0 / 3;
constexpr double share_of_median_most = 3;

/// Returns the torques of the nominal rigid body, T x n.
MatrixXd nominal_torques(const Robot& robot, const TrainingData& data) {
    const std::vector<double> gains(robot.joints.size(), 1);
    const auto regressor = robot_regressor(chain_model(robot, OutputKind::joint_torque), {}, gains);
    const VectorXd parameters = nominal_parameters(robot, OutputKind::joint_torque);
    MatrixXd torques(data.positions.rows(), data.positions.cols());
    MatrixXd rows;
    for (Index t = 0; t < torques.rows(); ++t) {
        regressor->evaluate({data.positions.row(t).transpose(), data.velocities.row(t).transpose(),
                             data.accelerations.row(t).transpose()},
                            rows);
        torques.row(t) = (rows * parameters).transpose();
    }
    return torques;
}

double gain_of(const VectorXd& current, const VectorXd& torque, const VectorXd& velocity,
               double sign_velocity) {
    MatrixXd columns(current.size(), 4);
    columns << torque, velocity, (velocity / sign_velocity).array().tanh(), VectorXd::Ones(current.size());
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

std::vector<TorqueGain> estimate_torque_gains(const Robot& robot, const TrainingData& data,
                                              double sign_velocity) {
    const MatrixXd torques = nominal_torques(robot, data);
    std::vector<double> found;
    for (Index i = 0; i < torques.cols(); ++i) {
        found.push_back(gain_of(data.outputs.col(i), torques.col(i), data.velocities.col(i), sign_velocity));
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

} // namespace dfdyn::tools
