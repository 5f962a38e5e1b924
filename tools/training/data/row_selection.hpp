// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

using RowList = std::vector<Eigen::Index>; ///< ascending row numbers

/// Rows whose lag window of `lags` + 1 rows lies in one uninterrupted stretch. O(T).
RowList usable_rows(const std::vector<std::uint8_t>& gap_before, int lags);

/// Rows in motion and rows at rest.
struct MotionSplit {
    RowList moving;
    RowList still;
};

/// A row is at rest when, over its lag window, no joint covers 1 % of the widest range that any joint covers
/// in any window. `rows` must be usable with the same `lags`. O(rows * n * lags).
MotionSplit split_by_motion(const Eigen::MatrixXd& positions, const RowList& rows, int lags);

/// At most `count` rows for the exact likelihood: evenly strided over the rows in motion, with at most 5 %
/// rows at rest (a long standstill would repeat one sample and drown the rest; strided rows are also less
/// correlated than a solid block).
RowList likelihood_rows(const MotionSplit& split, int count);

} // namespace dfdyn::tools
