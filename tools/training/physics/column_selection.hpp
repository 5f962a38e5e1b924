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
/// span of those chosen before. Equal columns: the first. scale = 1 / (root mean square of the column).
/// O(rows P^2). 0 < threshold < 1.
///
/// Two kinds of columns are never chosen, because division by the norm would make a parameter of them that no
/// machine can have:
/// - columns whose effect is below `rounding_share` of the largest column's. A regressor in double carries
///   errors of about 1e-16 of its largest entries for each joint passed; what is smaller than 1e-10 of them
///   is rounding error and says nothing about the motion.
/// - columns whose effect is below `least_effect`: even the largest parameter that a machine has would change
///   no output by more than that share of its deviation. What remains unexplained of an output is larger, so
///   the recording cannot determine such a parameter, and any value that a fit gave it would act on the next
///   motion.
/// The effect of a column is its root mean square over the rows times the parameter's entry in `size`, the
/// magnitude that a machine can have (P, > 0). Without sizes (empty), every entry counts as 1 and only the
/// first rule applies. The second rule requires that `psi` is in units of the outputs' deviations.
ColumnChoice select_columns(const Eigen::MatrixXd& psi, double threshold, const Eigen::VectorXd& size = {});

inline constexpr double rounding_share = 1e-10;
inline constexpr double least_effect = 0.01;

} // namespace dfdyn::tools
