// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace dfdyn::hal {

using SixValues = std::array<double, 6>;

/// Solves matrix * x = right by Gaussian elimination with partial pivoting. Returns nothing if the matrix is
/// singular or contains a number that is not finite. About 150 multiply-adds. Eigen's solver is not used
/// because it takes 7 KB of flash and adds seconds to the compile time of every source that includes a
/// sensor.
[[nodiscard]] inline std::optional<SixValues> solve(std::array<SixValues, 6> matrix,
                                                    SixValues right) noexcept {
    for (std::size_t column = 0; column < 6; ++column) {
        std::size_t largest = column;
        for (std::size_t row = column + 1; row < 6; ++row) {
            largest = std::abs(matrix[row][column]) > std::abs(matrix[largest][column]) ? row : largest;
        }
        std::swap(matrix[column], matrix[largest]);
        std::swap(right[column], right[largest]);
        const double pivot = matrix[column][column];
        if (!std::isfinite(pivot) || pivot == 0) {
            return std::nullopt;
        }
        for (std::size_t row = column + 1; row < 6; ++row) {
            const double factor = matrix[row][column] / pivot;
            right[row] -= factor * right[column];
            for (std::size_t k = column + 1; k < 6; ++k) {
                matrix[row][k] -= factor * matrix[column][k];
            }
        }
    }
    for (std::size_t row = 6; row-- > 0;) {
        for (std::size_t k = row + 1; k < 6; ++k) {
            right[row] -= matrix[row][k] * right[k];
        }
        right[row] /= matrix[row][row];
    }
    return right;
}

} // namespace dfdyn::hal
