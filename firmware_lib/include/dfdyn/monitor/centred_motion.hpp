// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

namespace dfdyn {

/// Computes Savitzky-Golay rows for position, velocity and acceleration in the middle of a window of M+1
/// samples (M even, ≥ 2) with the sample period `period` (s): the least-squares parabola (A. Savitzky and
/// M. J. E. Golay, 1964). `rows`: 3 × (M+1), newest sample first. The result is M/2 samples old and has no
/// phase lag at that time.
template <class Scalar>
constexpr void centred_motion_rows(int lags, Scalar period, Scalar* rows) noexcept {
    const int half = lags / 2;
    const auto count = static_cast<Scalar>(lags + 1);
    Scalar square = 0;
    for (int l = -half; l <= half; ++l) {
        square += static_cast<Scalar>(l * l);
    }
    const Scalar mean_square = square / count;
    Scalar fourth = 0;
    for (int l = -half; l <= half; ++l) {
        const Scalar bow = static_cast<Scalar>(l * l) - mean_square;
        fourth += bow * bow;
    }
    for (int lag = 0; lag <= lags; ++lag) {
        const int l = half - lag;
        const Scalar bow = (static_cast<Scalar>(l * l) - mean_square) / fourth;
        rows[lag] = 1 / count - bow * mean_square;
        rows[lags + 1 + lag] = static_cast<Scalar>(l) / (square * period);
        rows[2 * (lags + 1) + lag] = 2 * bow / (period * period);
    }
}

} // namespace dfdyn
