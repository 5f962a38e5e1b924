// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/inputs/input_description.hpp"

#include <memory>
#include <utility>

namespace dfdyn::tests {

/// Returns the rows of an input.
inline std::unique_ptr<tools::RowFamily> row_family(tools::InputKind kind, int lags, int rows_per_joint = 0,
                                                    Eigen::MatrixXd pooled_factor = {}) {
    return tools::input_description(kind).rows({lags, rows_per_joint, std::move(pooled_factor)});
}

} // namespace dfdyn::tests
