// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/robot_prior.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index random_states = 300;
constexpr double random_weight = 0.03; // weight of the random states' rows relative to the recording's

/// Returns states that excite every joint with the speed of the recording's fastest joint.
MotionSamples random_motion(const MotionSamples& recorded) {
    NormalSource random(1);
    const Index joints = recorded.positions.cols();
    const auto largest = [&](const MatrixXd& of_joints) {
        return (of_joints.colwise().norm() / std::sqrt(static_cast<double>(of_joints.rows()))).maxCoeff();
    };
    return {std::numbers::pi * random.matrix(random_states, joints).array().sin(),
            largest(recorded.velocities) * random.matrix(random_states, joints),
            largest(recorded.accelerations) * random.matrix(random_states, joints)};
}

/// Returns all columns, with the outputs below each other, divided by the outputs' standard deviations: (N m)
/// x P.
MatrixXd stacked_columns(const TrainingSetup& setup, const MotionSamples& motion) {
    const Regressor& regressor = *setup.options.physics.regressor;
    const MatrixXd columns = all_columns(regressor, motion);
    const VectorXd deviations = output_deviations(setup);
    MatrixXd stacked(columns.rows() * regressor.outputs(), regressor.columns());
    for (Index k = 0; k < regressor.outputs(); ++k) {
        stacked.middleRows(k * columns.rows(), columns.rows()) =
            columns.middleCols(k * regressor.columns(), regressor.columns()) / deviations[k];
    }
    return stacked;
}

/// Returns p x P: the contribution of each parameter to the chosen ones, in units of their scales.
MatrixXd expressed_by(const TrainingSetup& setup, const ColumnChoice& choice, const VectorXd& motion) {
    const MotionSamples recorded = setup.motion(setup.options.input, setup.rows.likelihood)->evaluate(motion);
    const MatrixXd data = stacked_columns(setup, recorded);
    const MatrixXd random = stacked_columns(setup, random_motion(recorded));
    const double share =
        random_weight * std::sqrt(static_cast<double>(data.rows()) / static_cast<double>(random.rows()));
    MatrixXd all(data.rows() + random.rows(), data.cols());
    all << data, share * random;
    const MatrixXd chosen = all(Eigen::all, choice.columns) * choice.scale.asDiagonal();
    return least_squares(chosen, all);
}

} // namespace

double parameter_variance_factor(const TrainingSetup& setup) {
    // over all phases of the lags
    const double rows_per_s = setup.options.every / setup.data.sample_period_s;
    const double correlation_s =
        setup.options.model->fits_jointly() ? residual_correlation_with_features_s : residual_correlation_s;
    return std::max(1.0, correlation_s * rows_per_s);
}

ParameterPrior robot_prior(const TrainingSetup& setup, const ColumnChoice& choice, const VectorXd& motion) {
    const PhysicsOptions& physics = setup.options.physics;
    const MatrixXd expressed = expressed_by(setup, choice, motion);
    const MatrixXd root = expressed * physics.nominal_deviation.asDiagonal();
    const MatrixXd covariance = root * root.transpose();
    const Index p = covariance.rows();
    return {expressed * physics.nominal, parameter_variance_factor(setup) *
                                             solve_symmetric(covariance, MatrixXd(MatrixXd::Identity(p, p)))};
}

} // namespace dfdyn::tools
