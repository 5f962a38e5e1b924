// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/physics_columns.hpp"

namespace dfdyn::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd all_columns(const Regressor& regressor, const MotionSamples& motion) {
    const Index outputs = regressor.outputs();
    const Index columns = regressor.columns();
    MatrixXd result(motion.positions.rows(), outputs * columns);
    MatrixXd sample(outputs, columns);
    for (Index t = 0; t < result.rows(); ++t) {
        regressor.evaluate(motion.at(t), sample);
        for (Index k = 0; k < outputs; ++k) {
            result.row(t).segment(k * columns, columns) = sample.row(k);
        }
    }
    return result;
}

MatrixXd chosen_columns(const Regressor& regressor, const MotionSamples& motion, const ColumnChoice& choice) {
    const MatrixXd all = all_columns(regressor, motion);
    const auto p = static_cast<Index>(choice.columns.size());
    MatrixXd result(all.rows(), regressor.outputs() * p);
    for (Index k = 0; k < regressor.outputs(); ++k) {
        for (Index c = 0; c < p; ++c) {
            const Index from = k * regressor.columns() + choice.columns[static_cast<std::size_t>(c)];
            result.col(k * p + c) = choice.scale[c] * all.col(from);
        }
    }
    return result;
}

MatrixXd RegressorColumns::evaluate(const VectorXd& parameters) const {
    return chosen_columns(regressor_, motion_->evaluate(parameters), choice_);
}

VectorXd RegressorColumns::pull_back(const VectorXd& parameters, const MatrixXd& gradient) const {
    if (!motion_->learns()) {
        return VectorXd::Zero(parameters.size());
    }
    const MotionSamples motion = motion_->evaluate(parameters);
    const auto p = static_cast<Index>(choice_.columns.size());
    MotionGradient slopes{MatrixXd::Zero(motion.positions.rows(), motion.positions.cols()),
                          MatrixXd::Zero(motion.positions.rows(), motion.positions.cols())};
    MatrixXd sample = MatrixXd::Zero(regressor_.outputs(), regressor_.columns());
    for (Index t = 0; t < gradient.rows(); ++t) {
        for (Index k = 0; k < sample.rows(); ++k) {
            for (Index c = 0; c < p; ++c) {
                sample(k, choice_.columns[static_cast<std::size_t>(c)]) =
                    choice_.scale[c] * gradient(t, k * p + c);
            }
        }
        const RegressorGradient at = regressor_.pull_back(motion.at(t), sample);
        slopes.velocities.row(t) = at.velocity.transpose();
        slopes.accelerations.row(t) = at.acceleration.transpose();
    }
    return motion_->pull_back(parameters, slopes);
}

} // namespace dfdyn::tools
