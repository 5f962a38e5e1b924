// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

#include <cmath>

namespace dfdyn::tests {

/// Appends a row to a recording without gaps: positions (n, rad) and outputs (m).
inline void append_row(tools::Recording& recording, double time_s,
                       const Eigen::Ref<const Eigen::VectorXd>& position,
                       const Eigen::Ref<const Eigen::VectorXd>& output) {
    recording.gap_before.push_back(recording.row_count() == 0 ? 1 : 0);
    recording.time_s.push_back(time_s);
    recording.time_ns.push_back(std::llround(1e9 * time_s));
    const auto append = [](tools::Columns& columns, const Eigen::Ref<const Eigen::VectorXd>& row) {
        columns.values.insert(columns.values.end(), row.begin(), row.end());
    };
    append(recording.position, position);
    append(recording.output, output);
}

} // namespace dfdyn::tests
