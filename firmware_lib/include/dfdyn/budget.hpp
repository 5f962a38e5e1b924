// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <cstdint>
#include <limits>

namespace dfdyn {

/// How much learning one tick may do, in multiply-adds: one per product or quotient, with the sum that takes
/// it up, and `function_cost` per square root, exponential, logarithm or hyperbolic tangent. The costs of the
/// parts are constant expressions of the sizes (`Estimator::cost()`), so that a loop can be given a share of
/// its period.
struct Budget {
    std::int64_t operations = 0;

    static constexpr Budget unlimited() noexcept { return {std::numeric_limits<std::int64_t>::max()}; }
    static constexpr Budget predict_only() noexcept { return {0}; }

    [[nodiscard]] constexpr bool affords(std::int64_t cost) const noexcept { return cost <= operations; }

    /// Takes `cost` if it is there.
    constexpr bool spend(std::int64_t cost) noexcept {
        if (!affords(cost)) {
            return false;
        }
        operations -= cost;
        return true;
    }
};

/// A call of an elementary function, in multiply-adds.
inline constexpr int function_cost = 30;

/// The cost of a tick's parts, in multiply-adds; the time they take is these numbers times a factor of the
/// machine.
struct Cost {
    std::int64_t
        predict; ///< input, features, weights, estimate: the most of any tick, of one with a measurement
    /// A separate variance, in ticks that do not learn their own sample at once: the most, with a sample in
    /// hand.
    std::int64_t variance;
    std::int64_t learn;  ///< learning one sample, without forgetting
    std::int64_t forget; ///< what forgetting adds to that, at most
    std::int64_t
        largest_step; ///< the largest part that learning is sliced into: a smaller budget may not get on
    /// What it takes, within the budget and before the next sample, when the arm is found to have changed.
    std::int64_t reset_covariance = 0;
};

/// Bytes of stack for the registers that a part's calls save, at most.
///
/// What grows with sizes in the bytes of stack is what the code keeps there; the numbers beside it are those
/// of g++ 12 -O3 on the Cortex-M, measured, with some room (firmware_lib/examples/cortex_m/parts.cpp holds
/// every part to them). What an interrupt pushes comes on top.
inline constexpr std::int64_t frame_bytes = 128;

/// The bytes that an estimator takes.
struct Footprint {
    std::int64_t state_bytes;    ///< RAM: the estimator itself
    std::int64_t constant_bytes; ///< flash: the constants, and where learning starts
    std::int64_t stack_bytes;    ///< of any of its calls, at most
};

} // namespace dfdyn
