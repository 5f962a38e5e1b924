// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Detects two nodes that use one CAN identifier, with a leaky bucket (GCRA; Turner 1986). One node sends at
/// most one frame per period, and each frame arrives at most `delay` later. So two frames may arrive within
/// less than a period, as they often do on a loaded bus, but not more frames than periods have passed. A node
/// that is slower than its period, pauses, or sends on request is never suspected.
///
/// The state is the earliest time at which the last frame can have been sent: not earlier than `delay` before
/// its arrival, and not earlier than a period after the frame before.
class SendRateGate {
  public:
    struct Config {
        std::int64_t period_ns;             ///< between two frames of the sender, by its own clock; > 0
        std::int64_t delay_ns;              ///< jitter, and waiting for the bus; 0 … period
        std::int64_t clock_tolerance = 128; ///< its period is shorter by at most this part of it
    };

    explicit constexpr SendRateGate(const Config& config) noexcept
        : shortest_ns_(config.period_ns - config.period_ns / config.clock_tolerance),
          delay_ns_(config.delay_ns) {}

    /// Takes a frame and returns true if its sender cannot be that of the frame before. If so, the state
    /// restarts with this frame. Frames that share a stamp, or arrive out of order, are no evidence.
    constexpr bool too_soon(std::int64_t stamp_ns) noexcept {
        if (started_ && stamp_ns <= last_ns_) {
            return false;
        }
        const bool soon = started_ && !could_have_sent_again_by(stamp_ns);
        const std::int64_t earliest_ns = stamp_ns - (soon ? delay_ns_ / 2 : delay_ns_); // after a detection
        sent_ns_ = started_ && !soon ? std::max(earliest_ns, sent_ns_ + shortest_ns_) : earliest_ns;
        last_ns_ = stamp_ns;
        started_ = true;
        return soon;
    }

    /// Returns true if one sender can have sent another frame by then. Requires a frame.
    [[nodiscard]] constexpr bool could_have_sent_again_by(std::int64_t stamp_ns) const noexcept {
        return sent_ns_ + shortest_ns_ <= stamp_ns;
    }

    /// Notes that the last frames of two identifiers were sent together: both get the later earliest time.
    static constexpr void sent_together(SendRateGate& one, SendRateGate& other) noexcept {
        one.sent_ns_ = other.sent_ns_ = std::max(one.sent_ns_, other.sent_ns_);
    }

  private:
    std::int64_t shortest_ns_;
    std::int64_t delay_ns_;
    std::int64_t sent_ns_ = 0; ///< earliest send time of the last frame
    std::int64_t last_ns_ = 0;
    bool started_ = false;
};

/// Also rejects the frames right after the detection of a second sender. Of two interleaved senders, every
/// other frame is in time.
class CollisionHold {
  public:
    /// Returns true if this frame is rejected. `too_soon`: result of a SendRateGate.
    constexpr bool seen(bool too_soon) noexcept {
        count_ += too_soon ? 1U : 0U;
        left_ = too_soon ? frames : left_ - (left_ > 0 ? 1 : 0);
        return left_ > 0;
    }

    /// Returns how many times a second sender was detected.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return count_; }

  private:
    static constexpr int frames = 2; ///< this one and the next
    int left_ = 0;
    std::uint64_t count_ = 0;
};

} // namespace dfdyn::hal
