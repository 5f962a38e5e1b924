// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Detects an effort that repeats its value while the joint moves; at rest a constant effort is no fault. The
/// length of such runs depends on the device's resolution. The limit is therefore twice the longest run of
/// equal values that ended with a change of a few counts. Runs are measured in periods and include lost
/// values. O(1).
class FrozenEffortGate {
  public:
    /// `limit`: number of periods with equal values that no device has, at least 2. `period_ns`: of the
    /// values; 0: unknown, so that lost values are not counted.
    explicit constexpr FrozenEffortGate(int limit, std::int64_t period_ns = 0) noexcept
        : limit_(limit), period_ns_(period_ns) {}

    /// Takes a value and returns true if the effort is frozen. `position_rad`: last trusted position of the
    /// joint; `stamp_ns`: of the value, increasing.
    constexpr bool frozen(double effort, double position_rad, std::int64_t stamp_ns = 0) noexcept {
        const int passed = periods_since(last_ns_, stamp_ns);
        last_ns_ = stamp_ns;
        if (run_ == 0 || effort != last_) {
            end_run(effort, position_rad);
        }
        run_ = std::min(run_ + (run_ == 0 ? 1 : passed), limit_);
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
    static constexpr int runs_to_learn = 40; ///< runs of the moving joint until the limit is adapted
    static constexpr int slack = 6;          ///< periods, beyond twice the longest run
    /// A silence counts at most this many periods. Then value, silence and equal value are no frozen effort,
    /// even of a device that never repeated one: 1 + 6 < 2 * 1 + 6.
    static constexpr int longest_silence = slack;

    [[nodiscard]] constexpr int periods_since(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
        if (period_ns_ <= 0) {
            return 1;
        }
        const std::int64_t apart_ns = wrapping_difference(to_ns, from_ns);
        const std::int64_t periods =
            apart_ns / period_ns_ + (apart_ns % period_ns_ >= period_ns_ / 2 ? 1 : 0);
        return static_cast<int>(std::clamp<std::int64_t>(periods, 1, longest_silence));
    }

    constexpr void end_run(double effort, double position_rad) noexcept {
        const double change = magnitude(effort - last_);
        if (run_ > 0) {
            smallest_change_ = smallest_change_ > 0 ? std::min(smallest_change_, change) : change;
            const bool moved = magnitude(position_rad - begin_rad_) > motion_of_a_value_rad;
            const bool learning = learned_ < runs_to_learn && run_ < limit_;
            const bool smooth = learning || !frozen_ || change <= 3 * smallest_change_;
            longest_ = moved && smooth ? std::max(longest_, run_) : longest_;
            learned_ = std::min(learned_ + (moved ? 1 : 0), runs_to_learn);
            longest_at_any_speed_ = smooth ? std::max(longest_at_any_speed_, run_) : longest_at_any_speed_;
            learned_at_any_speed_ = std::min(learned_at_any_speed_ + 1, runs_to_learn);
        }
        run_ = 0;
        last_ = effort;
        begin_rad_ = position_rad;
        frozen_ = false;
    }

    [[nodiscard]] constexpr int limit() const noexcept {
        const int longest = learned_ < runs_to_learn ? longest_at_any_speed_ : longest_;
        return learned_at_any_speed_ < runs_to_learn ? limit_ : std::min(limit_, 2 * longest + slack);
    }

    int limit_;
    std::int64_t period_ns_;
    std::int64_t last_ns_ = 0;
    int run_ = 0; ///< periods since its first value
    int longest_ = 1;
    int learned_ = 0;
    int longest_at_any_speed_ = 1; ///< includes the joint at rest, whose effort changes less
    int learned_at_any_speed_ = 0;
    double last_ = 0;
    double smallest_change_ = 0;
    double begin_rad_ = 0;
    bool frozen_ = false;
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
