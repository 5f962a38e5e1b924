// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

using RowList = std::vector<Eigen::Index>; ///< row numbers

/// Returns the rows whose lag window of `lags` + 1 rows has no gap. O(T).
RowList usable_rows(const std::vector<std::uint8_t>& gap_before, int lags);

/// Rows in motion and rows at rest.
struct MotionSplit {
    RowList moving;
    RowList still;
};

/// Divides the rows. A row is at rest if, over its lag window, no joint covers 1 % of the largest range that
/// any joint covers in any window. `rows` must be usable with the same `lags`. O(rows * n * lags).
MotionSplit split_by_motion(const Eigen::MatrixXd& positions, const RowList& rows, int lags);

/// Returns at most `count` rows for the exact likelihood: evenly strided over the rows in motion, with at
/// most 5 % rows at rest. A long standstill would repeat one sample and dominate the others. Strided rows are
/// also less correlated than a contiguous block.
RowList likelihood_rows(const MotionSplit& split, int count);

} // namespace dfdyn::tools
