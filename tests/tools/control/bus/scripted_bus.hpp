// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"

#include <algorithm>
#include <vector>

namespace dfdyn::tests {

/// A bus that a test controls: the frames that wait, its state, and how many frames it accepts.
struct ScriptedBus {
    std::vector<hal::Frame> waiting, taken;
    std::size_t room = 1000;
    std::int64_t time_ns = 0;
    hal::BusState bus_state = hal::BusState::active;
    hal::BusCounters bus_counters;

    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        const std::size_t count = std::min(into.size(), waiting.size());
        const auto end = waiting.begin() + static_cast<std::ptrdiff_t>(count);
        std::copy(waiting.begin(), end, into.begin());
        waiting.erase(waiting.begin(), end);
        return into.first(count);
    }
    hal::SendResult send(const hal::Frame& frame) noexcept {
        if (taken.size() >= room) {
            return hal::SendResult::refused;
        }
        taken.push_back(frame);
        taken.back().stamp_ns = time_ns;
        return hal::SendResult::sent;
    }
    std::int64_t now_ns() const noexcept { return time_ns; }
    hal::BusState state() const noexcept { return bus_state; }
    const hal::BusCounters& counters() const noexcept { return bus_counters; }
};

static_assert(hal::Bus<ScriptedBus>);

} // namespace dfdyn::tests
