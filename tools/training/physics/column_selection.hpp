// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// The columns of a regressor that a recording can distinguish, and the units of their parameters.
struct ColumnChoice {
    std::vector<Eigen::Index> columns; ///< ascending
    Eigen::VectorXd scale;             ///< of each chosen column, > 0
};

/// Chooses columns of `psi` (any rows x P) by a rank-revealing factorization with column pivoting, after
/// division of each column by its norm. A column is left out if less than `threshold` of it is outside the
/// span of those chosen before. Of equal columns, the first is chosen. scale = 1 / (root mean square of the
/// column). O(rows P^2). 0 < threshold < 1.
///
/// Two kinds of columns are never chosen, because division by the norm would give their parameters values
/// that are physically impossible:
/// - Columns whose effect is below `rounding_share` of the largest column's. A regressor in double has errors
///   of about 1e-16 of its largest entries for each joint passed. Columns below 1e-10 of them are rounding
///   errors and contain no information on the motion.
/// - Columns whose effect is below `least_effect`: even the largest plausible parameter would change no
///   output by more than this share of its standard deviation. The unexplained part of an output is larger.
///   The recording therefore cannot determine the parameter, and a fitted value would act on the next motion.
///
/// The effect of a column is its root mean square over the rows times the parameter's entry in `size`, its
/// largest plausible magnitude (P, > 0). Without sizes (empty), every entry counts as 1 and only the first
/// rule applies. The second rule requires `psi` in units of the outputs' standard deviations.
ColumnChoice select_columns(const Eigen::MatrixXd& psi, double threshold, const Eigen::VectorXd& size = {});

inline constexpr double rounding_share = 1e-10;
inline constexpr double least_effect = 0.01;

} // namespace dfdyn::tools
