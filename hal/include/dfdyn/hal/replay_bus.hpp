// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/bus_event.hpp"
#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/log_clock.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn::hal {

/// One frame of a recording.
struct ReplayEntry {
    Frame frame{};                    ///< with the recorder's time stamp
    std::uint64_t dropped_before = 0; ///< frames that the recorder lost since the previous one
};

/// Source of the frames of a recording, in its order. `next(entry)` fills `entry` and returns true. At the
/// end, or where the recording becomes unreadable, it fills only `dropped_before` and returns false.
template <class S>
concept ReplaySource = requires(S source, ReplayEntry& entry) {
    { source.next(entry) }
    noexcept->std::same_as<bool>;
};

/// A recording with the interface of a `Bus`. Its clock is that of the recording and moves only by
/// `advance_to`, so the same calls give the same frames. O(1) memory, and O(1) per frame besides the cost of
/// `Source::next`.
///
///     ReplayBus bus(source);
///     while (!bus.ended()) {
///         bus.advance_to(bus.next_stamp_ns());
///         decode(bus.drain(frames));
///     }
///
/// Frames come in the order and with the time stamps of the recording when they are due on its clock
/// (`LogClock`). A frame whose time stamp runs backward is due immediately. Error frames change `state()`;
/// frames that the recorder lost count as `dropped`.
template <ReplaySource Source>
class ReplayBus {
  public:
    /// Number of sent frames that are stored until `take_sent`; further frames are refused.
    static constexpr std::size_t sent_capacity = 64;

    /// Sets the clock to the time stamp of the first frame. `source` must outlive the bus.
    explicit ReplayBus(Source& source) noexcept : source_(source) {
        fetch();
        now_ns_ = due_ns_;
    }

    /// Moves the clock to `time_ns`. Has no effect if that time has passed.
    void advance_to(std::int64_t time_ns) noexcept { now_ns_ = std::max(now_ns_, time_ns); }

    /// Returns the time at which the next frame is due, at least the current time. Returns the current time
    /// after the end of the recording.
    std::int64_t next_stamp_ns() const noexcept { return ended_ ? now_ns_ : std::max(now_ns_, due_ns_); }

    /// Returns true if all frames have been returned by `drain`.
    bool ended() const noexcept { return ended_; }

    /// Returns the frames that are due, at most `into.size()`, as the filled part of `into`.
    std::span<const Frame> drain(std::span<Frame> into) noexcept {
        std::size_t count = 0;
        while (count < into.size() && is_due()) {
            into[count] = next_.frame;
            ++count;
            ++counters_.received;
            counters_.dropped += next_.dropped_before;
            note_frame(next_.frame, state_, counters_);
            fetch();
        }
        counters_.saturated_drains += count == into.size() && is_due() ? 1 : 0;
        return into.first(count);
    }

    /// Stores `frame` for `take_sent`, stamped with the current time.
    SendResult send(const Frame& frame) noexcept {
        if (!is_well_formed(frame) || frame.error) {
            return SendResult::invalid;
        }
        if (state_ == BusState::off) {
            return SendResult::bus_closed;
        }
        if (counters_.sent - taken_ == sent_capacity) {
            ++counters_.send_refused;
            return SendResult::refused;
        }
        Frame& kept = sent_[counters_.sent % sent_capacity];
        kept = frame;
        kept.stamp_ns = now_ns_;
        kept.stamp_source = StampSource::log;
        kept.origin = Origin::this_socket;
        ++counters_.sent;
        return SendResult::sent;
    }

    /// Returns the sent frames that were not taken before, in order, at most `into.size()`. A simulated plant
    /// or a test reads here what a real bus would carry.
    std::span<const Frame> take_sent(std::span<Frame> into) noexcept {
        std::size_t count = 0;
        while (count < into.size() && taken_ < counters_.sent) {
            into[count] = sent_[taken_ % sent_capacity];
            ++count;
            ++taken_;
        }
        return into.first(count);
    }

    /// Returns the time of the replay, which the caller advances.
    std::int64_t now_ns() const noexcept { return now_ns_; }
    /// Returns the state that the recording's error frames describe.
    BusState state() const noexcept { return state_; }
    /// Returns the counters after the last drain or send.
    const BusCounters& counters() const noexcept { return counters_; }

  private:
    bool is_due() const noexcept { return !ended_ && due_ns_ <= now_ns_; }

    /// Reads one frame ahead. Frames lost before a frame are counted when that frame is returned by `drain`.
    void fetch() noexcept {
        next_ = {};
        ended_ = !source_.next(next_);
        if (ended_) {
            counters_.dropped += next_.dropped_before;
        } else {
            due_ns_ = clock_.due_ns(next_.frame.stamp_ns);
        }
    }

    Source& source_;
    ReplayEntry next_{};
    bool ended_ = false;
    LogClock clock_;
    std::int64_t due_ns_ = 0; ///< due time of the next frame
    std::int64_t now_ns_ = 0;
    BusState state_ = BusState::active;
    BusCounters counters_{};
    std::array<Frame, sent_capacity> sent_{};
    std::uint64_t taken_ = 0; ///< number of sent frames already taken
};

} // namespace dfdyn::hal
