// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <cstdint>
#include <limits>

namespace dfdyn {

/// Upper bound on the learning work of one tick, in multiply-adds. One product or quotient, with the sum that
/// follows it, counts as one. A square root, exponential, logarithm or tanh counts as `function_cost`.
/// The costs of all parts are constant expressions of the sizes (`Estimator::cost()`), so a control loop can
/// assign a share of its period to learning.
struct Budget {
    std::int64_t operations = 0; ///< multiply-adds that are left

    /// Returns a budget in which a sample is learned in its own tick.
    static constexpr Budget unlimited() noexcept { return {std::numeric_limits<std::int64_t>::max()}; }
    /// Returns a budget with which nothing is learned.
    static constexpr Budget predict_only() noexcept { return {0}; }

    /// Returns whether `cost` multiply-adds are left.
    [[nodiscard]] constexpr bool affords(std::int64_t cost) const noexcept { return cost <= operations; }

    /// Subtracts `cost` and returns true if the budget affords it; otherwise returns false and changes
    /// nothing.
    constexpr bool spend(std::int64_t cost) noexcept {
        if (!affords(cost)) {
            return false;
        }
        operations -= cost;
        return true;
    }
};

/// Cost of one call of an elementary function, in multiply-adds.
inline constexpr int function_cost = 30;

/// Cost of the parts of a tick, in multiply-adds. Execution time is proportional to these numbers; the factor
/// depends on the machine.
struct Cost {
    /// Input, features, weights and estimate: maximum over all ticks, reached with a measurement.
    std::int64_t predict;
    /// Variance, if it is computed separately: in ticks that do not learn their own sample at once. Maximum,
    /// reached while an earlier sample is being learned.
    std::int64_t variance;
    std::int64_t learn;  ///< learning one sample, without forgetting
    std::int64_t forget; ///< maximum that forgetting adds to `learn`
    /// Largest indivisible part of learning. With a smaller budget learning may never finish.
    std::int64_t largest_step;
    /// Resetting the covariance after a change of the arm, within the budget and before the next sample is
    /// learned.
    std::int64_t reset_covariance = 0;
};

/// Maximum stack bytes for the registers that the calls of one part save.
///
/// The size-dependent stack bytes are counted from the data that the code keeps there. The constants added to
/// them were measured with g++ 12 -O3 on the Cortex-M and rounded up; tests/cortex_m/images/parts.cpp checks
/// every part. The frame that an interrupt pushes is not included.
inline constexpr std::int64_t frame_bytes = 128;

/// Memory of an estimator, in bytes.
struct Footprint {
    std::int64_t state_bytes;    ///< RAM: the estimator itself
    std::int64_t constant_bytes; ///< flash: the constants and the initial state of learning
    std::int64_t stack_bytes;    ///< maximum over all calls
};

} // namespace dfdyn
