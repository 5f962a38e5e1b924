// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Where an arm is and how it moves: n joints each, in rad (m), per s and per s^2.
struct MotionState {
    Eigen::VectorXd position;
    Eigen::VectorXd velocity;
    Eigen::VectorXd acceleration;
};

/// Gradient of a scalar with respect to the moving part of MotionState; positions are measured, nothing is
/// learned of them.
struct RegressorGradient {
    Eigen::VectorXd velocity;
    Eigen::VectorXd acceleration;
};

/// psi' of eq. par_regr_model: outputs are its product with the parameters.
class Regressor {
  public:
    Regressor() = default;
    Regressor(const Regressor&) = delete;
    Regressor& operator=(const Regressor&) = delete;
    virtual ~Regressor() = default;

    virtual Eigen::Index outputs() const = 0;
    virtual Eigen::Index columns() const = 0;

    /// Writes outputs x columns.
    virtual void evaluate(const MotionState& state, Eigen::MatrixXd& values) const = 0;

    /// Chain rule, from the gradient with respect to each entry of the values.
    virtual RegressorGradient pull_back(const MotionState& state, const Eigen::MatrixXd& gradient) const = 0;
};

} // namespace dfdyn::tools
