// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Computes the factors U (strictly upper part, by columns, as in StartModel) and D of `covariance` = U D U'.
/// Throws InputError unless it is positive definite. O(p^3).
void store_covariance(const Eigen::MatrixXd& covariance, std::vector<double>& unit_upper,
                      std::vector<double>& diagonal);

} // namespace dfdyn::tools
