// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/row_selection.hpp"

#include <algorithm>

namespace dfdyn::tools {
namespace {

constexpr double rest_fraction = 0.01;    // of the widest range covered in a window
constexpr double still_share_most = 0.05; // of the likelihood rows

double widest_range(const Eigen::MatrixXd& positions, Eigen::Index row, int lags) {
    const auto window = positions.middleRows(row - lags, lags + 1);
    return (window.colwise().maxCoeff() - window.colwise().minCoeff()).maxCoeff();
}

RowList strided(const RowList& rows, std::size_t count) {
    RowList picked;
    picked.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        picked.push_back(rows[(2 * i + 1) * rows.size() / (2 * count)]);
    }
    return picked;
}

} // namespace

RowList usable_rows(const std::vector<std::uint8_t>& gap_before, int lags) {
    RowList rows;
    int predecessors = 0;
    for (std::size_t row = 0; row < gap_before.size(); ++row) {
        predecessors = row == 0 || gap_before[row] != 0 ? 0 : predecessors + 1;
        if (predecessors >= lags) {
            rows.push_back(static_cast<Eigen::Index>(row));
        }
    }
    return rows;
}

MotionSplit split_by_motion(const Eigen::MatrixXd& positions, const RowList& rows, int lags) {
    std::vector<double> range;
    range.reserve(rows.size());
    for (const Eigen::Index row : rows) {
        range.push_back(widest_range(positions, row, lags));
    }
    const double threshold = rows.empty() ? 0 : rest_fraction * *std::max_element(range.begin(), range.end());
    MotionSplit split;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        (range[i] > threshold ? split.moving : split.still).push_back(rows[i]);
    }
    return split;
}

RowList likelihood_rows(const MotionSplit& split, int count) {
    const double still_most =
        still_share_most * std::min(static_cast<double>(count),
                                    static_cast<double>(split.moving.size()) / (1 - still_share_most));
    const std::size_t still = std::min(split.still.size(), static_cast<std::size_t>(still_most));
    const std::size_t moving = std::min(split.moving.size(), static_cast<std::size_t>(count) - still);
    RowList picked = strided(split.moving, moving);
    const RowList resting = strided(split.still, still);
    picked.insert(picked.end(), resting.begin(), resting.end());
    std::sort(picked.begin(), picked.end());
    return picked;
}

} // namespace dfdyn::tools
