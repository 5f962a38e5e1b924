// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Which columns of a regressor a recording can tell apart, and the unit that each of their parameters is
/// measured in.
struct ColumnChoice {
    std::vector<Eigen::Index> columns; ///< ascending
    Eigen::VectorXd scale;             ///< of each chosen column, > 0
};

/// Chooses columns of `psi` (any rows x P) by a rank-revealing factorisation with column pivoting, each
/// column divided by its norm first: a column is left out when less than `threshold` of it lies outside the
/// span of those chosen before. Columns of zeros are never chosen. Equal columns: the first. scale = 1 /
/// (root mean square of the column). O(rows P^2). 0 < threshold < 1.
ColumnChoice select_columns(const Eigen::MatrixXd& psi, double threshold);

} // namespace dfdyn::tools
