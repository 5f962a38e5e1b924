// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Detects an effort that repeats the same value while its joint moves; at rest a constant effort is no
/// fault. The length of such runs in motion depends on the device's resolution. So the limit is twice the
/// longest run of equal values that ended with a change of a few counts. Shorter runs may be coincidence.
/// O(1).
class FrozenEffortGate {
  public:
    /// `limit`: equal values in a row that are too many for any device, at least 2.
    explicit constexpr FrozenEffortGate(int limit) noexcept : limit_(limit) {}

    /// Whether this value is one too many. `position_rad`: the joint's last trusted position.
    constexpr bool frozen(double effort, double position_rad) noexcept {
        if (run_ == 0 || effort != last_) {
            end_run(effort, position_rad);
        }
        run_ = std::min(run_ + 1, limit_);
        const bool moved = magnitude(position_rad - begin_rad_) > motion_of_a_run_rad;
        const bool now = frozen_ || (run_ >= limit() && moved);
        episodes_ += now && !frozen_ ? 1U : 0U;
        frozen_ = now;
        return now;
    }

    /// Number of times the effort froze.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return episodes_; }

  private:
    static constexpr double motion_of_a_run_rad = 5e-3;
    static constexpr double motion_of_a_value_rad = 2e-4;
    static constexpr int enough = 40; ///< runs of the moving joint

    constexpr void end_run(double effort, double position_rad) noexcept {
        const double change = magnitude(effort - last_);
        if (run_ > 0) {
            smallest_change_ = smallest_change_ > 0 ? std::min(smallest_change_, change) : change;
            const bool moved = magnitude(position_rad - begin_rad_) > motion_of_a_value_rad;
            const bool learning = learned_ < enough && run_ < limit_;
            const bool smooth = learning || !frozen_ || change <= 3 * smallest_change_;
            longest_ = moved && smooth ? std::max(longest_, run_) : longest_;
            learned_ = std::min(learned_ + (moved ? 1 : 0), enough);
            longest_at_any_speed_ = smooth ? std::max(longest_at_any_speed_, run_) : longest_at_any_speed_;
            learned_at_any_speed_ = std::min(learned_at_any_speed_ + 1, enough);
        }
        run_ = 0;
        last_ = effort;
        begin_rad_ = position_rad;
        frozen_ = false;
    }

    [[nodiscard]] constexpr int limit() const noexcept {
        const int longest = learned_ < enough ? longest_at_any_speed_ : longest_;
        return learned_at_any_speed_ < enough ? limit_ : std::min(limit_, 2 * longest + 6);
    }

    int limit_;
    int run_ = 0;
    int longest_ = 1;
    int learned_ = 0;
    int longest_at_any_speed_ = 1; ///< also of the joint at rest, whose effort changes less
    int learned_at_any_speed_ = 0;
    double last_ = 0;
    double smallest_change_ = 0;
    double begin_rad_ = 0;
    bool frozen_ = false;
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
