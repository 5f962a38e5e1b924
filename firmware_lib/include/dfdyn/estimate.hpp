// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/status.hpp"
#include "dfdyn/core/storage.hpp"

#include <cstdint>

namespace dfdyn {

/// Result of one tick. Never feed the prediction forward: it is the torque of the measured motion (positive
/// feedback); use `FeedForward`. Without a prediction it is 0, and its standard deviation is infinite. A
/// prediction beyond the model's `prediction_limit` is replaced by that limit, and its standard deviation is
/// at least the distance between the two.
template <class Scalar, int m>
struct Estimate {
    Storage<Scalar, m> prediction;         ///< in the output's unit, computed before the sample is learned
    Storage<Scalar, m> standard_deviation; ///< of the measurement about the prediction: parameters and noise
    Storage<Scalar, m> innovation;         ///< measured - prediction; 0 without a usable measurement
    /// Sum over the outputs of (measured - prediction)² / `standard_deviation`², both before the bound. About
    /// m while the model is valid, 0 without a measurement. If outputs share parameters (P, SPK) it is not
    /// chi-square, because the correlation of their errors is ignored.
    Scalar normalised_innovation_squared;
    Status status; ///< whether there is a prediction, whether the sample was learned, and why not
};

/// Number of occurrences of each reason since the last reset; monotonic in between. 64 bits suffice for 584
/// million years at 1 kHz. 32 bits would wrap after 49.7 days, and a saturated counter would hide every later
/// fault. A 32-bit core reads a counter in two loads, so read it in the context that ticks, or while nothing
/// ticks.
struct Counters {
    std::uint64_t ticks = 0;     ///< calls of `tick`
    std::uint64_t predicted = 0; ///< ticks with a prediction of the model itself, within its bound
    std::uint64_t learned = 0;   ///< samples learned completely
    /// Indexed by the reason's number: the reason of the prediction, or of learning if predicted.
    Storage<std::uint64_t, reason_count> reasons{};
};

} // namespace dfdyn
