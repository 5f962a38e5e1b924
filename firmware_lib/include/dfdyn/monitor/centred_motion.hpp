// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

namespace dfdyn {

/// Rows that give position, velocity and acceleration in the middle of a window of M+1 samples (M even, ≥ 2),
/// `period` s apart, by the parabola of least squares through it (A. Savitzky and M. J. E. Golay, 1964): 3 ×
/// (M+1), newest first. Half a window late, but with no lag of their own: who compares them with an output
/// takes that of M/2 samples ago.
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
