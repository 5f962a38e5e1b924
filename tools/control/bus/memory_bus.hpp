// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/wall_clock.hpp"

#include <algorithm>
#include <deque>

namespace dfdyn::tools {

/// One end of a simulated wire within the program, with a simulated clock (hal::Bus). A frame sent at one end
/// waits at the other, with a stamp of that end's wall clock. When it is read, its stamp is converted to the
/// clock of `now_ns`, as in hal::SocketCanBus.
class MemoryBus {
  public:
    /// Connects two ends. Both must outlive their use.
    static void join(MemoryBus& one, MemoryBus& other) noexcept {
        one.other_ = &other;
        other.other_ = &one;
    }

    void set_time(std::int64_t now_ns) noexcept { now_ns_ = now_ns; }

    /// Sets the lead of the wall clock over the simulated clock.
    void set_wall_clock(std::int64_t ahead_ns) noexcept { ahead_ns_ = ahead_ns; }

    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        const std::size_t count = std::min(into.size(), waiting_.size());
        const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(count);
        std::copy(waiting_.begin(), end, into.begin());
        waiting_.erase(waiting_.begin(), end);
        for (hal::Frame& frame : into.first(count)) {
            frame.stamp_ns = clock_.to_monotonic(frame.stamp_ns, now_ns_, now_ns_ + ahead_ns_).stamp_ns;
        }
        if (count < into.size()) {
            clock_.nothing_waiting(now_ns_, now_ns_ + ahead_ns_);
        }
        counters_.received += count;
        return into.first(count);
    }

    hal::SendResult send(const hal::Frame& frame) noexcept {
        other_->waiting_.push_back(frame);
        other_->waiting_.back().stamp_ns = other_->now_ns_ + other_->ahead_ns_;
        ++counters_.sent;
        return hal::SendResult::sent;
    }

    std::int64_t now_ns() const noexcept { return now_ns_; }
    hal::BusState state() const noexcept { return hal::BusState::active; }
    const hal::BusCounters& counters() const noexcept { return counters_; }

  private:
    MemoryBus* other_ = nullptr;
    std::deque<hal::Frame> waiting_;
    std::int64_t now_ns_ = 0, ahead_ns_ = 0;
    hal::WallClock clock_;
    hal::BusCounters counters_;
};

static_assert(hal::Bus<MemoryBus>);

} // namespace dfdyn::tools
