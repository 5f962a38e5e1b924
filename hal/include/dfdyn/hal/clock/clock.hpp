// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Compares the stamps of one bus with the time at which they are read. Rejects a stamp ahead of that time,
/// and one further behind the latest stamp than frames overtake each other. After several consistent rejected
/// stamps, their clock is adopted: its stamps are shifted so that they continue the old ones. The resulting
/// time is never ahead, and runs backward by at most `tolerance`.
class ClockGate {
  public:
    struct Config {
        std::int64_t tolerance_ns = 5'000'000;  ///< largest lead, and largest lag behind the latest stamp
        std::int64_t max_step_ns = 100'000'000; ///< between consistent frames, and age of the first
        int adopt_after = 20;                   ///< consistent frames, at least 1
    };

    explicit constexpr ClockGate(const Config& config) noexcept : config_(config) {}

    /// Returns the stamp on the time base of `now_ns`, or nothing if it is rejected.
    constexpr std::optional<std::int64_t> accept(std::int64_t stamp_ns, std::int64_t now_ns) noexcept {
        const std::int64_t shifted_ns = wrapping_sum(stamp_ns, offset_ns_);
        const bool ahead = shifted_ns > wrapping_sum(now_ns, config_.tolerance_ns);
        const std::int64_t earliest_ns = started_ ? wrapping_sum(latest_ns_, -config_.tolerance_ns)
                                                  : wrapping_sum(now_ns, -config_.max_step_ns);
        const bool behind = shifted_ns < earliest_ns;
        if (!ahead && !behind) {
            run_ = 0;
            return follow(std::min(shifted_ns, now_ns));
        }
        ++refused_;
        if (!consistent(stamp_ns)) {
            return std::nullopt;
        }
        ++adopted_;
        run_ = 0;
        offset_ns_ = wrapping_difference(now_ns, stamp_ns);
        latest_ns_ = now_ns;
        return follow(now_ns);
    }

    /// Returns true if the last frame was rejected.
    [[nodiscard]] constexpr bool doubtful() const noexcept { return run_ > 0; }
    [[nodiscard]] constexpr std::uint64_t refused() const noexcept { return refused_; }

    /// Returns how many times another clock was adopted.
    [[nodiscard]] constexpr std::uint64_t adopted() const noexcept { return adopted_; }

  private:
    constexpr std::int64_t follow(std::int64_t stamp_ns) noexcept {
        latest_ns_ = started_ ? std::max(latest_ns_, stamp_ns) : stamp_ns;
        started_ = true;
        return stamp_ns;
    }

    /// Returns true if this rejected stamp completes a run that is long enough.
    constexpr bool consistent(std::int64_t stamp_ns) noexcept {
        const std::int64_t step_ns = wrapping_difference(stamp_ns, last_refused_ns_);
        const bool goes_on = run_ > 0 && step_ns >= -config_.tolerance_ns && step_ns <= config_.max_step_ns;
        run_ = goes_on ? run_ + 1 : 1;
        last_refused_ns_ = stamp_ns;
        return run_ >= config_.adopt_after;
    }

    Config config_;
    std::int64_t offset_ns_ = 0;
    std::int64_t latest_ns_ = 0;
    std::int64_t last_refused_ns_ = 0;
    bool started_ = false;
    int run_ = 0;
    std::uint64_t refused_ = 0;
    std::uint64_t adopted_ = 0;
};

} // namespace dfdyn::hal
