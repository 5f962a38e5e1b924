// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Clock of a recording. It follows the time stamps of the frames and never runs backward.
/// - A frame stamped at most `overtaken_ns` before the latest one was overtaken by it. It is due immediately.
/// - A frame stamped earlier than that is an outlier or the first after a step of the clock. It is due
///   immediately, too.
/// - After `set_back_after` consecutive frames with such stamps the recorder's clock is known to have been
///   set back. Time then continues from the latest time, advanced by the duration of these frames. From then
///   on this clock is ahead of the stamps, like the clock of a live bus (`ClockGate`), and the frames in
///   between are a gap.
class LogClock {
  public:
    /// Largest distance of a stamp behind the latest one of a frame that was merely overtaken.
    static constexpr std::int64_t overtaken_ns = 5'000'000;
    static constexpr std::int64_t longest_step_ns =
        100'000'000; ///< longest interval between consecutive frames
    /// Consecutive frames with earlier stamps after which the recorder's clock is known to have been set
    /// back.
    static constexpr int set_back_after = 20;

    /// Returns the time at which the next frame of the recording is due. O(1).
    constexpr std::int64_t due_ns(std::int64_t stamp_ns) noexcept {
        if (!started_) {
            started_ = true;
            latest_ns_ = stamp_ns;
        }
        if (wrapping_difference(latest_ns_, wrapping_sum(stamp_ns, offset_ns_)) <= overtaken_ns) {
            run_ = 0;
        } else if (goes_on(stamp_ns)) {
            offset_ns_ = wrapping_difference(latest_ns_, run_begin_ns_);
            run_ = 0;
            ++set_back_;
        }
        latest_ns_ = time_of(stamp_ns);
        return latest_ns_;
    }

    /// Returns the time at which a frame with this time stamp would be due, without changing the clock.
    /// Requires at least one frame before.
    [[nodiscard]] constexpr std::int64_t time_of(std::int64_t stamp_ns) const noexcept {
        return std::max(latest_ns_, wrapping_sum(stamp_ns, offset_ns_));
    }

    /// Returns true if the time stamp is so far ahead of the latest that it may be an outlier.
    [[nodiscard]] constexpr bool leads(std::int64_t stamp_ns) const noexcept {
        return started_ && wrapping_difference(wrapping_sum(stamp_ns, offset_ns_), latest_ns_) > overtaken_ns;
    }

    /// Offset from the time stamps to this clock.
    [[nodiscard]] constexpr std::int64_t offset_ns() const noexcept { return offset_ns_; }

    /// Number of times the recorder's clock was set back.
    [[nodiscard]] constexpr std::uint64_t set_back() const noexcept { return set_back_; }

  private:
    /// Adds a time stamp that is behind the latest to the current run of such stamps. Returns true if the run
    /// is long enough.
    constexpr bool goes_on(std::int64_t stamp_ns) noexcept {
        const std::int64_t step_ns = wrapping_difference(stamp_ns, behind_ns_);
        const bool next = run_ > 0 && step_ns >= -overtaken_ns && step_ns <= longest_step_ns;
        run_ = next ? run_ + 1 : 1;
        run_begin_ns_ = next ? run_begin_ns_ : stamp_ns;
        behind_ns_ = stamp_ns;
        return run_ >= set_back_after;
    }

    std::int64_t latest_ns_ = 0;
    std::int64_t offset_ns_ = 0;
    std::int64_t behind_ns_ = 0;    ///< time stamp of the last frame that was behind
    std::int64_t run_begin_ns_ = 0; ///< time stamp of the first frame of the current run
    std::uint64_t set_back_ = 0;
    int run_ = 0; ///< number of consecutive frames that were behind
    bool started_ = false;
};

} // namespace dfdyn::hal
