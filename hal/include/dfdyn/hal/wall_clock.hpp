// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Converts wall-clock time stamps to the monotonic clock, even if the wall clock is set meanwhile. A time
/// stamp is shifted by the difference of the two clocks when it is read. Frames that were waiting or being
/// delivered while the wall clock was set need the difference before. They are recognised because only that
/// difference places them between now and the last time at which no frame was waiting. If the clock was set
/// by less than `delivery_ns`, a stamp of these frames may be wrong by that. Allocates nothing; O(1) per
/// stamp.
class WallClock {
  public:
    /// A larger change of the difference means that the clock was set; slewing changes it by far less.
    static constexpr std::int64_t step_ns = 1'000'000;
    /// A stamped frame is assumed to be readable after at most this time. Its software interrupt usually
    /// delivers it at once, but waits for a thread if the kernel is busy.
    static constexpr std::int64_t delivery_ns = 50'000'000;

    /// A converted time stamp.
    struct Converted {
        std::int64_t stamp_ns = 0; ///< on the monotonic clock, never after now
        bool plausible = false;    ///< false: no difference explains the time stamp, and `stamp_ns` is now
    };

    /// Reports both clocks at a time when no frame is waiting to be read.
    constexpr void nothing_waiting(std::int64_t monotonic_ns, std::int64_t wall_ns) noexcept {
        note_difference(monotonic_ns, wall_ns);
        empty_ns_ = monotonic_ns;
        was_set_ = was_set_ && monotonic_ns - set_ns_ <= delivery_ns;
    }

    /// Converts the wall-clock time stamp `stamp_ns`, read when the clocks show `monotonic_ns` and `wall_ns`.
    constexpr Converted to_monotonic(std::int64_t stamp_ns, std::int64_t monotonic_ns,
                                     std::int64_t wall_ns) noexcept {
        note_difference(monotonic_ns, wall_ns);
        const std::int64_t after_ns = stamp_ns + offset_ns_;
        const std::int64_t before_ns = stamp_ns + (was_set_ ? previous_offset_ns_ : offset_ns_);
        // Most frames are delivered at once, so a time stamp after the last empty reading is the likelier
        // one.
        for (const std::int64_t delay_ns : {step_ns, delivery_ns}) {
            for (const std::int64_t candidate_ns : {after_ns, before_ns}) {
                const bool too_early = was_set_ && candidate_ns < empty_ns_ - delay_ns;
                if (!too_early && candidate_ns < monotonic_ns + step_ns) {
                    return {std::min(candidate_ns, monotonic_ns), true};
                }
            }
        }
        return {monotonic_ns, false};
    }

  private:
    constexpr void note_difference(std::int64_t monotonic_ns, std::int64_t wall_ns) noexcept {
        const std::int64_t offset_ns = monotonic_ns - wall_ns;
        const std::int64_t change_ns = offset_ns - offset_ns_;
        if (started_ && (change_ns > step_ns || change_ns < -step_ns)) {
            previous_offset_ns_ = offset_ns_;
            set_ns_ = monotonic_ns;
            was_set_ = true;
        }
        offset_ns_ = offset_ns;
        started_ = true;
    }

    std::int64_t offset_ns_ = 0;
    std::int64_t previous_offset_ns_ = 0; ///< difference before the wall clock was last set
    std::int64_t set_ns_ = 0;             ///< when this was noticed, on the monotonic clock
    std::int64_t empty_ns_ = 0;
    bool started_ = false;
    bool was_set_ = false; ///< frames from before the wall clock was set may still come
};

/// Converts time stamps of a controller's own clock, with unknown origin and a slightly different rate, to
/// the monotonic clock. No frame is read before it is stamped, so the smallest observed delay from stamp to
/// reading is the best estimate of the difference of the clocks. The estimate is relaxed by 1 /
/// `drift_divisor` of the elapsed time so that it can follow the drift of the clocks. The remaining delay,
/// the smallest one among the frames of the last seconds, is a constant offset. A delay that is smaller by
/// more than `fall_ns` is believed after `agreeing` frames in a row: one wrong stamp would shift all stamps
/// for as long as the relaxation takes.
class HardwareClock {
  public:
    /// An increase of the difference by more than this means that the clock was reset or wrapped.
    static constexpr std::int64_t reset_ns = 10'000'000'000;
    /// One part in 5,000 (200 ppm), because crystals agree to 100 ppm.
    static constexpr std::int64_t drift_divisor = 5'000;
    /// Largest fall of the smallest delay that one frame can show.
    static constexpr std::int64_t fall_ns = 2'000'000;
    static constexpr int agreeing = 4; ///< frames in a row that show a larger fall

    /// Converts the controller's time stamp `stamp_ns`, read at `monotonic_ns`. The result is never later
    /// than `monotonic_ns`.
    constexpr std::int64_t to_monotonic(std::int64_t stamp_ns, std::int64_t monotonic_ns) noexcept {
        const std::int64_t difference_ns = monotonic_ns - stamp_ns;
        const std::int64_t relaxed_ns = offset_ns_ + (monotonic_ns - read_ns_) / drift_divisor;
        const bool reset = !started_ || difference_ns - relaxed_ns > reset_ns;
        falls_ = relaxed_ns - difference_ns > fall_ns ? falls_ + 1 : 0;
        if (reset || falls_ == agreeing) {
            offset_ns_ = difference_ns;
            falls_ = 0;
        } else {
            offset_ns_ = falls_ > 0 ? relaxed_ns : std::min(relaxed_ns, difference_ns);
        }
        read_ns_ = monotonic_ns;
        started_ = true;
        return std::min(stamp_ns + offset_ns_, monotonic_ns);
    }

  private:
    std::int64_t offset_ns_ = 0; ///< monotonic clock minus the controller's clock
    std::int64_t read_ns_ = 0;
    int falls_ = 0; ///< in a row, below `agreeing`
    bool started_ = false;
};

} // namespace dfdyn::hal
