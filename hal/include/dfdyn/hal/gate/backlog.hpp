// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Recognises frames that waited while nobody read them, such as during a stall of the recorder. After a
/// pause they arrive within less than half a period of each other, at most as many as periods have passed.
/// Each has the time at which it was read, not that of its measurement. O(1).
class BacklogGate {
  public:
    /// `period_ns`: between two frames of the sender; > 0.
    explicit constexpr BacklogGate(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}

    /// Takes the stamp of a frame and returns true if the frame waited. Of the first frame after a pause this
    /// is not known, and the result is false.
    constexpr bool waited(std::int64_t stamp_ns) noexcept {
        const std::int64_t apart_ns = started_ ? stamp_ns - last_ns_ : 0;
        last_ns_ = stamp_ns;
        started_ = true;
        if (due_ > 0 && apart_ns < period_ns_ / 2) {
            --due_;
            return true;
        }
        due_ = 2 * apart_ns >= shortest_pause * period_ns_ ? (apart_ns + period_ns_ / 2) / period_ns_ - 1 : 0;
        return false;
    }

  private:
    /// Half periods. On a loaded bus two frames may come two periods apart, and the next one soon after.
    static constexpr std::int64_t shortest_pause = 5;

    std::int64_t period_ns_;
    std::int64_t last_ns_ = 0;
    std::int64_t due_ = 0; ///< frames that were due during the pause and have not arrived
    bool started_ = false;
};

} // namespace dfdyn::hal
