// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/frame.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Classes of error frames: bits of `Frame::id` with the values of Linux (linux/can/error.h).
namespace error_class {
inline constexpr std::uint32_t transmit_timeout = 0x001;   ///< the driver gave up sending a frame
inline constexpr std::uint32_t lost_arbitration = 0x002;   ///< another node had the lower identifier
inline constexpr std::uint32_t controller = 0x004;         ///< details are in data[1]: see controller_detail
inline constexpr std::uint32_t protocol = 0x008;           ///< bit, form or stuff error
inline constexpr std::uint32_t transceiver = 0x010;        ///< a level on CAN high or low is wrong
inline constexpr std::uint32_t no_acknowledgement = 0x020; ///< no other node acknowledged a frame
inline constexpr std::uint32_t bus_off = 0x040;            ///< the controller left the bus
inline constexpr std::uint32_t bus_error = 0x080;          ///< an error on the wire, of any kind
inline constexpr std::uint32_t restarted = 0x100;          ///< the controller is back after bus-off
/// error counters: data[6] for transmission, data[7] for reception
inline constexpr std::uint32_t counters = 0x200;
} // namespace error_class

/// Bits of data[1] in an error frame of the class `controller`. Where a constant has two bits, one is for
/// reception and one for transmission.
namespace controller_detail {
inline constexpr std::uint32_t receive_overflow = 0x01;  ///< a received frame was overwritten
inline constexpr std::uint32_t transmit_overflow = 0x02; ///< a frame to be sent was lost
inline constexpr std::uint32_t warning = 0x04 | 0x08;    ///< an error counter has reached 96
inline constexpr std::uint32_t passive = 0x10 | 0x20;    ///< an error counter is above 127
inline constexpr std::uint32_t active = 0x40;            ///< the error counters are low again
} // namespace controller_detail

namespace detail {

/// Returns the state that follows from the error counters. A counter is at most 255, so it can indicate
/// neither bus-off nor the end of bus-off.
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

/// Returns the state after an error frame. If one frame reports several states, bus-off has priority, and
/// then the worst error level. An error frame does not change `interface_down`: frames from before may still
/// be waiting, and only the backend knows when the interface is up again.
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

/// Evaluates a received frame: counts each class of an error frame and updates `state`.
/// - A repeated report of bus-off counts once.
/// - Lost arbitrations, missing acknowledgements and errors on the wire are counted but do not change the
///   state. The controller reports by itself when there are too many of them.
/// - Unknown classes count only as an error frame.
/// - A data frame from another node ends bus-off. A controller in bus-off receives nothing, and some drivers
///   do not report the restart.
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
