// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// The time that passes in a recording: that of its stamps, but it never runs backward. A frame stamped
/// before the latest by up to `overtaken_ns` was overtaken, and one further behind is a stray: both are due
/// at once. Where the recorder's clock was set back, which `set_back_after` frames that go on from each other
/// show, time goes on from the latest, and by as much as these frames took: from then on it is ahead of the
/// stamps, as the clock of a live bus is (`ClockGate`), and the frames in between are a gap.
class LogClock {
  public:
    static constexpr std::int64_t overtaken_ns = 5'000'000;
    static constexpr std::int64_t longest_step_ns =
        100'000'000; ///< between frames that go on from each other
    static constexpr int set_back_after = 20;

    /// The time at which the next frame of the recording is due. O(1).
    constexpr std::int64_t due_ns(std::int64_t stamp_ns) noexcept {
        if (!started_) {
            started_ = true;
            latest_ns_ = stamp_ns;
        }
        if (difference(latest_ns_, sum(stamp_ns, offset_ns_)) <= overtaken_ns) {
            run_ = 0;
        } else if (goes_on(stamp_ns)) {
            offset_ns_ = difference(latest_ns_, run_begin_ns_);
            run_ = 0;
            ++set_back_;
        }
        latest_ns_ = time_of(stamp_ns);
        return latest_ns_;
    }

    /// When a frame of that stamp would be due, as far as is known. Requires a frame.
    [[nodiscard]] constexpr std::int64_t time_of(std::int64_t stamp_ns) const noexcept {
        return std::max(latest_ns_, sum(stamp_ns, offset_ns_));
    }

    /// Whether a frame's stamp is so far ahead of the latest that it may be a stray.
    [[nodiscard]] constexpr bool leads(std::int64_t stamp_ns) const noexcept {
        return started_ && difference(sum(stamp_ns, offset_ns_), latest_ns_) > overtaken_ns;
    }

    /// What is added to the stamps.
    [[nodiscard]] constexpr std::int64_t offset_ns() const noexcept { return offset_ns_; }

    /// How often the recorder's clock was set back.
    [[nodiscard]] constexpr std::uint64_t set_back() const noexcept { return set_back_; }

  private:
    /// Stamps wrap instead of overflowing, whatever they are.
    [[nodiscard]] static constexpr std::int64_t sum(std::int64_t a, std::int64_t b) noexcept {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
    }
    [[nodiscard]] static constexpr std::int64_t difference(std::int64_t a, std::int64_t b) noexcept {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
    }

    /// Whether this stamp, which is behind, ends a run that is long enough.
    constexpr bool goes_on(std::int64_t stamp_ns) noexcept {
        const std::int64_t step_ns = difference(stamp_ns, behind_ns_);
        const bool next = run_ > 0 && step_ns >= -overtaken_ns && step_ns <= longest_step_ns;
        run_ = next ? run_ + 1 : 1;
        run_begin_ns_ = next ? run_begin_ns_ : stamp_ns;
        behind_ns_ = stamp_ns;
        return run_ >= set_back_after;
    }

    std::int64_t latest_ns_ = 0;
    std::int64_t offset_ns_ = 0;
    std::int64_t behind_ns_ = 0;    ///< stamp of the last frame that was behind
    std::int64_t run_begin_ns_ = 0; ///< stamp of the first of those in a row
    std::uint64_t set_back_ = 0;
    int run_ = 0; ///< frames that were behind, in a row
    bool started_ = false;
};

} // namespace dfdyn::hal
