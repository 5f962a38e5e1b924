// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace dfdyn {

/// How much learning one tick may do, in multiply-adds. The costs of the parts are constant expressions of
/// the sizes
/// (`Estimator::cost()`), so that a loop can be given a share of its period.
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

/// The cost of a tick's parts, in multiply-adds; the time they take is these numbers times a factor of the
/// machine.
struct Cost {
    std::int64_t predict;  ///< input, features, weights; done in every tick
    std::int64_t variance; ///< a separate variance; in ticks that do not learn their own sample at once
    std::int64_t learn;    ///< the whole of learning one sample
    std::int64_t
        largest_step; ///< the largest part that learning can be sliced into: no smaller budget makes progress
};

} // namespace dfdyn
