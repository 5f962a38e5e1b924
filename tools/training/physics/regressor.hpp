// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/motion.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Gradient of a scalar with respect to velocity and acceleration of MotionState. Positions are measured and
/// have no parameters.
struct RegressorGradient {
    Eigen::VectorXd velocity;
    Eigen::VectorXd acceleration;
};

/// Regressor psi' of the paper (Section III-A, eq. 3): outputs are its product with the parameters.
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

    /// Applies the chain rule to the gradient with respect to each entry of the values.
    virtual RegressorGradient pull_back(const MotionState& state, const Eigen::MatrixXd& gradient) const = 0;
};

} // namespace dfdyn::tools
