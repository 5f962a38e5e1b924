// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Concatenates two vectors; either may be empty.
inline Eigen::VectorXd stacked(const Eigen::VectorXd& first, const Eigen::VectorXd& second) {
    Eigen::VectorXd result(first.size() + second.size());
    result << first, second;
    return result;
}

} // namespace dfdyn::tools
