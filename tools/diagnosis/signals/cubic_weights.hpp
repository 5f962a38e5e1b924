// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns the weights of four samples, taken at different `times`, for cubic (Lagrange) interpolation at
/// `at`.
inline Eigen::RowVector4d cubic_weights(const Eigen::Vector4d& times, double at) {
    Eigen::RowVector4d weights = Eigen::RowVector4d::Ones();
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
            if (i != j) {
                weights[i] *= (at - times[j]) / (times[i] - times[j]);
            }
        }
    }
    return weights;
}

} // namespace dfdyn::tools
