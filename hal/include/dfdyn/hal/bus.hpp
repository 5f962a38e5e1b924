// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <concepts>
#include <cstdint>
#include <span>

namespace dfdyn::hal {

/// State of the CAN controller and of its interface, as last reported.
enum class BusState : std::uint8_t {
    active,  ///< error-active: no fault
    warning, ///< an error counter has reached 96, the error warning limit
    passive, ///< error-passive: an error counter is above 127; received frames are still valid
    off,     ///< bus-off: nothing is sent or received until the controller restarts
    /// the interface is down or removed; the bus reopens by itself when the interface is up again
    interface_down
};

/// Event counters of a bus since it was opened. They never decrease and never wrap.
struct BusCounters {
    std::uint64_t received = 0; ///< frames returned by `drain`, including error frames
    std::uint64_t sent = 0;     ///< frames accepted for sending
    /// Frames dropped because the send queue was full (ENOBUFS, EAGAIN). The bus does not wait for room.
    std::uint64_t send_refused = 0;
    std::uint64_t dropped = 0; ///< frames that the operating system dropped before they were read
    /// times the controller overwrote a frame before the driver had fetched it
    std::uint64_t controller_overruns = 0;
    std::uint64_t lost_arbitrations = 0;   ///< normal on a loaded bus, never a fault
    std::uint64_t no_acknowledgements = 0; ///< sent frames that no other node acknowledged
    std::uint64_t bus_errors = 0;          ///< bit, form, checksum and level errors on the wire
    std::uint64_t transmit_faults = 0; ///< times the controller lost a frame to be sent or gave up sending it
    std::uint64_t error_frames = 0;    ///< error frames of all classes
    std::uint64_t bus_off = 0;         ///< times the controller went bus-off
    std::uint64_t restarted = 0;       ///< times the controller restarted after bus-off
    std::uint64_t interface_down = 0;  ///< times the interface went down or was removed
    std::uint64_t truncated = 0;       ///< reads of a wrong size
    std::uint64_t saturated_drains = 0; ///< drains that reached their limit with frames left to read
};

enum class SendResult : std::uint8_t {
    sent,       ///< handed to the controller's queue
    refused,    ///< the queue is full: the frame is dropped and counted
    bus_closed, ///< bus-off, or the interface is down
    invalid ///< not a frame that this bus can carry: see `is_well_formed`; or CAN FD on a classic interface
};

/// Interface of a CAN bus: a real one (`SocketCanBus`) or a recording (`ReplayBus`). Once the bus is open, no
/// call blocks, allocates or throws, and each call ends after a bounded number of steps.
/// - `drain(into)`: returns the received frames in the order of arrival, at most `into.size()`, as the filled
///   part of `into`. Error frames are included; they are already counted and applied to `state()`.
/// - `send(frame)`: offers one frame for sending.
/// - `now_ns()`: the clock of the frames' time stamps, which never runs backward.
/// - `state()`, `counters()`: the values after the last drain or send.
template <class B>
concept Bus = requires(B bus, const B constant, std::span<Frame> into, const Frame& frame) {
    { bus.drain(into) }
    noexcept->std::same_as<std::span<const Frame>>;
    { bus.send(frame) }
    noexcept->std::same_as<SendResult>;
    { constant.now_ns() }
    noexcept->std::same_as<std::int64_t>;
    { constant.state() }
    noexcept->std::same_as<BusState>;
    { constant.counters() }
    noexcept->std::same_as<const BusCounters&>;
};

} // namespace dfdyn::hal
