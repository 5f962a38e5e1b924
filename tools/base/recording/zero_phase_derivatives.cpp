// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/zero_phase_derivatives.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/recording/stretches.hpp"

#include <Eigen/Core>

#include <utility>

namespace dfdyn::tools {

namespace {

/// Returns, for each row, the first row of its segment.
std::vector<Eigen::Index> beginnings(const Recording& recording) {
    std::vector<Eigen::Index> first;
    for (const Stretch& stretch : recorded_stretches(recording)) {
        first.insert(first.end(), static_cast<std::size_t>(stretch.count), stretch.first);
    }
    return first;
}

/// Rows: coefficients of the polynomial about `centre`; columns: weights of the samples from `begin` on.
Eigen::MatrixXd polynomial_weights(const Recording& recording, std::size_t begin, std::size_t centre,
                                   const ZeroPhaseWindow& window) {
    const int count = 2 * window.half_width + 1;
    const double span =
        recording.time_s[begin + static_cast<std::size_t>(count) - 1] - recording.time_s[begin];
    Eigen::MatrixXd powers(count, window.degree + 1);
    for (int i = 0; i < count; ++i) {
        const double t =
            (recording.time_s[begin + static_cast<std::size_t>(i)] - recording.time_s[centre]) / span;
        double power = 1;
        for (int k = 0; k <= window.degree; ++k) {
            powers(i, k) = power;
            power *= t;
        }
    }
    const auto [q, r] = orthogonal_factors(powers);
    Eigen::MatrixXd weights = r.triangularView<Eigen::Upper>().solve(q.transpose()).topRows(3);
    weights.row(1) /= span;
    weights.row(2) *= 2 / (span * span);
    return weights;
}

} // namespace

SampledDerivatives zero_phase_derivatives(const Recording& recording, const Columns& columns,
                                          const ZeroPhaseWindow& window) {
    const auto rows = static_cast<Eigen::Index>(recording.row_count());
    const auto signals = static_cast<Eigen::Index>(columns.names.size());
    const auto values = columns_matrix(columns);
    const std::vector<Eigen::Index> beginning = beginnings(recording);
    const auto half = static_cast<std::size_t>(window.half_width);
    SampledDerivatives result{Eigen::MatrixXd::Zero(rows, signals), Eigen::MatrixXd::Zero(rows, signals),
                              std::vector<std::uint8_t>(recording.row_count(), 0)};
    for (std::size_t row = half; row + half < recording.row_count(); ++row) {
        if (beginning[row - half] != beginning[row + half]) {
            continue;
        }
        const Eigen::MatrixXd weights = polynomial_weights(recording, row - half, row, window);
        const auto at = static_cast<Eigen::Index>(row);
        const auto around = values.middleRows(at - window.half_width, 2 * window.half_width + 1);
        result.first.row(at) = weights.row(1) * around;
        result.second.row(at) = weights.row(2) * around;
        result.valid[row] = 1;
    }
    return result;
}

} // namespace dfdyn::tools
