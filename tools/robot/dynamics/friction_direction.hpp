// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns the direction of dry friction for each velocity: tanh(velocity / scale), in (-1, 1). `scale` > 0,
/// in the velocity's unit: friction has three quarters of its full value there.
inline Eigen::VectorXd friction_direction(const Eigen::VectorXd& velocity, double scale) {
    return (velocity.array() / scale).tanh();
}

} // namespace dfdyn::tools
