// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/frame.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// The classes of an error frame: bits of `Frame::id`, as numbered by Linux (linux/can/error.h).
namespace error_class {
inline constexpr std::uint32_t transmit_timeout = 0x001;
inline constexpr std::uint32_t lost_arbitration = 0x002;
inline constexpr std::uint32_t controller = 0x004; ///< details: controller_detail, in data[1]
inline constexpr std::uint32_t protocol = 0x008;
inline constexpr std::uint32_t transceiver = 0x010;
inline constexpr std::uint32_t no_acknowledgement = 0x020;
inline constexpr std::uint32_t bus_off = 0x040;
inline constexpr std::uint32_t bus_error = 0x080;
inline constexpr std::uint32_t restarted = 0x100;
inline constexpr std::uint32_t counters = 0x200; ///< data[6] counts errors of sending, data[7] of receiving
} // namespace error_class

/// The bits of data[1] of an error frame of the class `controller`; where there are two, one is of receiving
/// and one of sending.
namespace controller_detail {
inline constexpr std::uint32_t receive_overflow = 0x01;
inline constexpr std::uint32_t transmit_overflow = 0x02;
inline constexpr std::uint32_t warning = 0x04 | 0x08;
inline constexpr std::uint32_t passive = 0x10 | 0x20;
inline constexpr std::uint32_t active = 0x40;
} // namespace controller_detail

namespace detail {

/// The state that the error counters tell. They end at 255, so they never tell bus-off, nor its end.
constexpr BusState state_of_counters(const Frame& frame, BusState before) noexcept {
    if (before == BusState::off) {
        return before;
    }
    const std::uint8_t largest = std::max(frame.data[6], frame.data[7]);
    if (largest > 127) {
        return BusState::passive;
    }
    return largest >= 96 ? BusState::warning : BusState::active;
}

/// The state after an error frame. Bus-off wins over all else in one frame; the worst level over the others.
/// That the interface is down, only its backend knows: frames may still be waiting from before.
constexpr BusState state_after(const Frame& frame, std::uint32_t details, BusState before) noexcept {
    if (before == BusState::interface_down) {
        return before;
    }
    if ((frame.id & error_class::bus_off) != 0) {
        return BusState::off;
    }
    if ((details & controller_detail::passive) != 0) {
        return BusState::passive;
    }
    if ((details & controller_detail::warning) != 0) {
        return BusState::warning;
    }
    if ((details & controller_detail::active) != 0 || (frame.id & error_class::restarted) != 0) {
        return BusState::active;
    }
    return (frame.id & error_class::counters) != 0 ? state_of_counters(frame, before) : before;
}

} // namespace detail

/// Takes note of what `frame` says about the controller: counts each class of an error frame and moves
/// `state`. A controller that is bus-off and reports it again has not gone bus-off twice. Lost arbitration,
/// missing acknowledgements and errors on the wire are counted and leave the state alone: the controller
/// itself reports when they are too many. Unknown classes count as an error frame and nothing else.
///
/// A frame from the bus ends bus-off: a controller that is bus-off receives nothing, and not every driver
/// reports the restart.
constexpr void note_frame(const Frame& frame, BusState& state, BusCounters& counters) noexcept {
    if (!frame.error) {
        const bool back = state == BusState::off && frame.origin == Origin::remote;
        state = back ? BusState::active : state;
        return;
    }
    const auto has = [&](std::uint32_t classes) { return (frame.id & classes) != 0; };
    const std::uint32_t details = has(error_class::controller) ? frame.data[1] : 0U;
    const BusState before = state;
    state = detail::state_after(frame, details, before);

    ++counters.error_frames;
    counters.bus_off += state == BusState::off && before != BusState::off ? 1 : 0;
    counters.restarted += has(error_class::restarted) ? 1 : 0;
    counters.lost_arbitrations += has(error_class::lost_arbitration) ? 1 : 0;
    counters.no_acknowledgements += has(error_class::no_acknowledgement) ? 1 : 0;
    counters.bus_errors +=
        has(error_class::protocol | error_class::transceiver | error_class::bus_error) ? 1 : 0;
    counters.controller_overruns += (details & controller_detail::receive_overflow) != 0 ? 1 : 0;
    counters.transmit_faults +=
        has(error_class::transmit_timeout) || (details & controller_detail::transmit_overflow) != 0 ? 1 : 0;
}

} // namespace dfdyn::hal
