// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns a view of the values of columns that are present, rows x names.
inline Eigen::Map<const RowMajorMatrix> columns_matrix(const Columns& columns) {
    const auto count = static_cast<Eigen::Index>(columns.names.size());
    return {columns.values.data(), static_cast<Eigen::Index>(columns.values.size()) / count, count};
}

} // namespace dfdyn::tools
