// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Moves stamps of a wall clock, which may be set while we run, onto the monotonic clock. A stamp is moved by
/// the difference of the two clocks at the time when it is read. Stamps that were waiting while the wall
/// clock was set belong to the difference before; they are told by where they land: between the last time
/// that nothing was waiting, and now. Heap-free; O(1) per stamp.
class WallClock {
  public:
    /// A change of the difference beyond this is a clock that was set; slewing moves it by far less.
    static constexpr std::int64_t step_ns = 1'000'000;

    struct Converted {
        std::int64_t stamp_ns = 0; ///< on the monotonic clock, never after now
        bool plausible = false;    ///< false: `stamp_ns` is now, because no difference explains the stamp
    };

    /// The clocks as they are when nothing is waiting to be read.
    constexpr void nothing_waiting(std::int64_t monotonic_ns, std::int64_t wall_ns) noexcept {
        offset_ns_ = monotonic_ns - wall_ns;
        empty_ns_ = monotonic_ns;
        was_set_ = false;
    }

    /// The wall clock's `stamp_ns`, read at `monotonic_ns`, when the wall clock shows `wall_ns`.
    constexpr Converted to_monotonic(std::int64_t stamp_ns, std::int64_t monotonic_ns,
                                     std::int64_t wall_ns) noexcept {
        const std::int64_t offset_ns = monotonic_ns - wall_ns;
        if (differ(offset_ns, offset_ns_)) {
            previous_offset_ns_ = offset_ns_;
            was_set_ = true;
        }
        offset_ns_ = offset_ns;
        for (const std::int64_t candidate_ns :
             {stamp_ns + offset_ns_, stamp_ns + (was_set_ ? previous_offset_ns_ : offset_ns_)}) {
            const bool too_early = was_set_ && candidate_ns < empty_ns_ - step_ns;
            if (!too_early && candidate_ns < monotonic_ns + step_ns) {
                return {std::min(candidate_ns, monotonic_ns), true};
            }
        }
        return {monotonic_ns, false};
    }

  private:
    static constexpr bool differ(std::int64_t one_ns, std::int64_t other_ns) noexcept {
        return one_ns - other_ns > step_ns || other_ns - one_ns > step_ns;
    }

    std::int64_t offset_ns_ = 0;
    std::int64_t previous_offset_ns_ = 0; ///< before the wall clock was last set
    std::int64_t empty_ns_ = 0;
    bool was_set_ = false; ///< since nothing was waiting
};

/// Moves stamps of a controller's own clock, of unknown origin and slightly other speed, onto the monotonic
/// clock. No frame is read before it was stamped, so the least delay seen from stamp to reading is the best
/// estimate of the clocks' difference; it is let go by `drift` so that it follows a clock that runs fast.
/// What is left of the delay, in the least of the frames of the last seconds, is a constant lateness.
class HardwareClock {
  public:
    /// A difference beyond this is a clock that was reset, or wrapped.
    static constexpr std::int64_t reset_ns = 10'000'000'000;
    /// Crystals agree to 100 ppm; one part in 5,000.
    static constexpr std::int64_t drift_divisor = 5'000;

    /// The controller's `stamp_ns`, read at `monotonic_ns`, on the monotonic clock; never after now.
    constexpr std::int64_t to_monotonic(std::int64_t stamp_ns, std::int64_t monotonic_ns) noexcept {
        const std::int64_t difference_ns = monotonic_ns - stamp_ns;
        const std::int64_t relaxed_ns = offset_ns_ + (monotonic_ns - read_ns_) / drift_divisor;
        const bool reset = !started_ || difference_ns - relaxed_ns > reset_ns;
        offset_ns_ = reset ? difference_ns : std::min(relaxed_ns, difference_ns);
        read_ns_ = monotonic_ns;
        started_ = true;
        return stamp_ns + offset_ns_;
    }

  private:
    std::int64_t offset_ns_ = 0; ///< monotonic minus the controller's
    std::int64_t read_ns_ = 0;
    bool started_ = false;
};

} // namespace dfdyn::hal
