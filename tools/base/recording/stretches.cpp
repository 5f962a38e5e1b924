// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/stretches.hpp"

#include "tools/base/numerics/quantile.hpp"

#include <utility>

namespace dfdyn::tools {

double time_step_s(const Recording& recording, std::size_t row) {
    return 1e-9 * static_cast<double>(recording.time_ns[row] - recording.time_ns[row - 1]);
}

double median_step_s(const Recording& recording) {
    std::vector<double> steps;
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        steps.push_back(time_step_s(recording, row));
    }
    return median(std::move(steps));
}

std::vector<Stretch> recorded_stretches(const Recording& recording) {
    const double longest = 3 * median_step_s(recording); // unused if there is no step
    std::vector<Stretch> result;
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        if (row == 0 || recording.gap_before[row] != 0 || time_step_s(recording, row) > longest) {
            result.push_back({static_cast<Eigen::Index>(row), 0});
        }
        ++result.back().count;
    }
    return result;
}

} // namespace dfdyn::tools
