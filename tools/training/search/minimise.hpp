// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/input_rows.hpp"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <optional>

namespace dfdyn::tools {

struct PointValue {
    double value = 0;
    Eigen::VectorXd gradient;
};

/// Nothing where the function has no finite value.
using Differentiable = std::function<std::optional<PointValue>(const Eigen::VectorXd&)>;

struct Minimum {
    Eigen::VectorXd point;                                  ///< the best point met, empty when there was none
    double value = std::numeric_limits<double>::infinity(); ///< infinity when no point had a finite value
    int evaluations = 0;
};

/// Local minimum in the box from `start` (moved into the box if outside), by NLopt with gradients. Stops when
/// the value changes by less than `tolerance`, absolutely, or after `evaluations_most`; never by time, so the
/// result is reproducible. With nothing to choose, the value at the empty point.
Minimum minimise(const Differentiable& function, const Bounds& bounds, const Eigen::VectorXd& start,
                 double tolerance, int evaluations_most);

} // namespace dfdyn::tools
