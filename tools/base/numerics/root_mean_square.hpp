// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cmath>

namespace dfdyn::tools {

/// Returns the root mean square of at least one value.
inline double root_mean_square(const Eigen::Ref<const Eigen::VectorXd>& values) {
    return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

} // namespace dfdyn::tools
