// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Bounds of the parameters for an optimiser, one entry per parameter; lower <= upper.
struct Bounds {
    Eigen::VectorXd lower;
    Eigen::VectorXd upper;
};

} // namespace dfdyn::tools
