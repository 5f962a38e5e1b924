// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Sines and cosines of an input over its range, two per order: the first pair turns by half a circle from
/// one end of the range to the other.
std::vector<Eigen::VectorXd> harmonics(const Eigen::VectorXd& input, int orders);

} // namespace dfdyn::tools
