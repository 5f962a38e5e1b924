// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/motion_run.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Recognises an encoder that counts from where it was switched on: its readings begin at its own zero. O(1).
class ZeroWatch {
  public:
    /// `velocity`: largest velocity of the joint (rad/s); `period_ns`: of the readings.
    constexpr ZeroWatch(double velocity, std::int64_t period_ns) noexcept
        : velocity_(velocity), period_s_(seconds_between(0, period_ns)) {}

    /// Accepts the first reading of a run.
    constexpr void note(const EncoderReading& first) noexcept {
        if (magnitude(first.from_zero_rad) <= velocity_ * period_s_ + 3 * first.step_rad) {
            saw(first.stamp_ns);
        }
    }

    /// Accepts the stamp of a reading at the zero.
    constexpr void saw(std::int64_t stamp_ns) noexcept {
        seen_ = true;
        stamp_ns_ = stamp_ns;
    }

    /// Forgets the zero that was seen: a reading is trusted.
    constexpr void forget() noexcept { seen_ = false; }

    [[nodiscard]] constexpr bool seen() const noexcept { return seen_; }

    /// Returns true if a run of this `velocity` that starts with `first` begins at the zero, or as far from
    /// it as the joint goes in a few periods. `trusted_velocity`: of the joint when it was last trusted;
    /// `hidden_s`: time before the run of which no reading is known.
    [[nodiscard]] constexpr bool is_begin(const EncoderReading& first, double velocity,
                                          double trusted_velocity, double hidden_s) const noexcept {
        constexpr double periods = 1.5;
        const double since_s = hidden_s + time_since_s(first.stamp_ns);
        const double fastest = std::max(magnitude(velocity), since_s > 0 ? magnitude(trusted_velocity) : 0);
        const double moved = fastest * (since_s + periods * period_s_);
        return magnitude(first.from_zero_rad) <= moved + 3 * first.step_rad;
    }

  private:
    /// Time (s) since a reading at the zero that did not come from the motion; 0: there was none.
    [[nodiscard]] constexpr double time_since_s(std::int64_t now_ns) const noexcept {
        constexpr double memory_s = 0.05; // a board shows its zero at the end of its start
        const double since_s = seconds_between(stamp_ns_, now_ns);
        return seen_ && since_s >= 0 && since_s <= memory_s ? since_s : 0; // < 0: the clock was set
    }

    double velocity_;
    double period_s_;
    std::int64_t stamp_ns_ = 0;
    bool seen_ = false; ///< since the last trusted reading
};

} // namespace dfdyn::hal
