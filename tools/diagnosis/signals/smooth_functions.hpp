// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Returns sines and cosines of an input over its range, one pair per order. The first pair covers half a
/// period over the range.
std::vector<Eigen::VectorXd> harmonics(const Eigen::VectorXd& input, int orders);

} // namespace dfdyn::tools
