// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"
#include "dfdyn/core/strict_math.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace dfdyn {

/// Limits and times of a `FeedForward` with n torques.
template <class Scalar, int n>
struct FeedForwardSettings {
    using Torques = Storage<Scalar, n>; ///< n values, one per joint

    std::int64_t period_ns;      ///< control period, > 0
    int ticks_per_sample;        ///< control ticks per sample period of the model, ≥ 1
    Torques limit;               ///< of each joint's torque, N·m, > 0
    Torques cap;                 ///< of the learned part beyond the nominal torque, N·m, ≥ 0
    Torques rate;                ///< of change of the learned part, N·m/s, > 0
    Scalar rise_s = Scalar(0.5); ///< time in which the learned share rises from 0 to 1, s, > 0
    Scalar fall_s = Scalar(0.2); ///< time in which it falls from 1 to 0, s, > 0
    Scalar memory_s = 1;         ///< memory of the comparison, from one to 10⁹ sample periods
    /// Weight of the error that the observer compensates, 0 … 1. A compromise between two cases: 0 is best
    /// for stop-and-go motions (both arms), 1 for tripled friction (the iCub's arm).
    Scalar slow_share = Scalar(0.3);
    /// Bandwidth of the disturbance observer, rad/s, ≥ 0 and below 1 / period; 0: none.
    Torques bandwidth{};
    Torques observer_limit{}; ///< of its estimate, N·m, ≥ 0; 0: it compensates nothing

    /// Returns the control period, s.
    [[nodiscard]] constexpr Scalar period_s() const noexcept {
        return Scalar(1e-9) * static_cast<Scalar>(period_ns);
    }
    /// Returns the sample period of the model, s.
    [[nodiscard]] constexpr Scalar sample_period_s() const noexcept {
        return period_s() * static_cast<Scalar>(ticks_per_sample);
    }

    /// Returns whether all values, of this number of joints, are finite and within their ranges.
    [[nodiscard]] bool valid(int joints) const noexcept {
        constexpr Scalar above_zero = std::numeric_limits<Scalar>::min();
        constexpr Scalar longest_memory = 1e9; // sample periods: their number is an int
        bool all = period_ns > 0 && ticks_per_sample > 0 && at_least(rise_s, above_zero) &&
                   at_least(fall_s, above_zero) && at_least(slow_share, 0) && slow_share <= 1 &&
                   at_least(memory_s, sample_period_s()) && memory_s <= longest_memory * sample_period_s();
        for (int k = 0; k < joints; ++k) {
            all = all && at_least(limit[k], above_zero) && at_least(cap[k], 0) &&
                  at_least(rate[k], above_zero) && at_least(bandwidth[k], 0) &&
                  bandwidth[k] * period_s() < 1 && at_least(observer_limit[k], 0);
        }
        return all;
    }

    /// Returns settings that allow no torque.
    [[nodiscard]] static FeedForwardSettings no_torque(Extent<n> joints) noexcept {
        const Torques zeros = Torques::zeros(joints);
        return {.period_ns = 1'000'000,
                .ticks_per_sample = 1,
                .limit = zeros,
                .cap = zeros,
                .rate = zeros,
                .bandwidth = zeros,
                .observer_limit = zeros};
    }

  private:
    static bool at_least(Scalar value, Scalar low) noexcept { return std::isfinite(value) && value >= low; }
};

} // namespace dfdyn
