// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/bounds.hpp"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <optional>

namespace dfdyn::tools {

struct PointValue {
    double value = 0;
    Eigen::VectorXd gradient;
};

/// Returns nothing where the function has no finite value.
using Differentiable = std::function<std::optional<PointValue>(const Eigen::VectorXd&)>;

struct Minimum {
    Eigen::VectorXd point;                                  ///< the best point; empty if there was none
    double value = std::numeric_limits<double>::infinity(); ///< infinite if no point had a finite value
    int evaluations = 0;
};

/// Finds a local minimum within the bounds from `start` (moved into the bounds if outside), by NLopt with
/// gradients. Stops when the value changes by less than `tolerance` (absolute), or after `evaluations_most`.
/// Time is no criterion, so the result is reproducible. Without parameters, returns the value at the empty
/// point.
Minimum minimise(const Differentiable& function, const Bounds& bounds, const Eigen::VectorXd& start,
                 double tolerance, int evaluations_most);

} // namespace dfdyn::tools
