// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"

#include <algorithm>
#include <deque>
#include <vector>

namespace dfdyn::tests {

/// A bus in memory. The test adds frames and sets its time and condition.
class TestBus {
  public:
    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        const std::size_t count = std::min(into.size(), waiting.size());
        std::copy_n(waiting.begin(), count, into.begin());
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(count));
        condition.received += count;
        condition.saturated_drains += waiting.empty() ? 0 : 1;
        return into.first(count);
    }

    hal::SendResult send(const hal::Frame& frame) noexcept {
        if (full) {
            ++condition.send_refused;
            return hal::SendResult::refused;
        }
        sent.push_back(frame);
        ++condition.sent;
        return hal::SendResult::sent;
    }

    [[nodiscard]] std::int64_t now_ns() const noexcept { return now; }
    [[nodiscard]] hal::BusState state() const noexcept { return bus_state; }
    [[nodiscard]] const hal::BusCounters& counters() const noexcept { return condition; }

    std::deque<hal::Frame> waiting; ///< frames to be read
    std::vector<hal::Frame> sent;
    std::int64_t now = 0;
    hal::BusState bus_state = hal::BusState::active;
    hal::BusCounters condition;
    bool full = false; ///< sending is refused
};

static_assert(hal::Bus<TestBus>);

} // namespace dfdyn::tests
