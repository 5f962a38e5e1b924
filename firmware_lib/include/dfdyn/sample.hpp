// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <cstdint>

namespace dfdyn {

/// Readings of the sensors at one time.
template <class Scalar, int n, int m>
struct Sample {
    std::int64_t time_ns;        ///< any monotonic clock; only differences matter
    Storage<Scalar, n> position; ///< rad (m for prismatic joints), base to tip
    Storage<Scalar, m> output;   ///< N·m, N, A …, as in the training data
    bool output_valid;           ///< false: no measurement, predict only
};

/// A sample of an arm whose velocities and accelerations are measured (input
/// `StandardMeasured`).
template <class Scalar, int n, int m>
struct SampleWithDerivatives : Sample<Scalar, n, m> {
    Storage<Scalar, n> velocity;     ///< rad/s
    Storage<Scalar, n> acceleration; ///< rad/s²
};

} // namespace dfdyn
