// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <concepts>
#include <cstdint>
#include <span>

namespace dfdyn::hal {

/// State of the controller and of its interface, as last reported.
enum class BusState : std::uint8_t {
    active,        ///< error-active: all is well
    warning,       ///< an error counter is above 96
    passive,       ///< error-passive: a counter is above 127; what is received is still good
    off,           ///< bus-off: nothing is sent or received until the controller restarts
    interface_down ///< the interface is down or gone; the bus reopens by itself when it is back
};

/// What happened on a bus since it was opened. Counters never run backward and never wrap.
struct BusCounters {
    std::uint64_t received = 0; ///< frames handed out, error frames included
    std::uint64_t sent = 0;     ///< frames accepted for sending
    /// Frames for which the queue had no room (ENOBUFS, EAGAIN): dropped, not waited for.
    std::uint64_t send_refused = 0;
    std::uint64_t dropped = 0;             ///< frames the operating system dropped before they were read
    std::uint64_t controller_overruns = 0; ///< times the controller overwrote a frame that nobody had fetched
    std::uint64_t lost_arbitrations = 0;   ///< normal on a loaded bus; never a fault
    std::uint64_t no_acknowledgements = 0; ///< sent frames that no other node acknowledged
    std::uint64_t bus_errors = 0;          ///< bits, forms, checksums or levels that were wrong on the wire
    std::uint64_t transmit_faults = 0;     ///< times the controller lost a frame it was to send, or gave up
    std::uint64_t error_frames = 0;        ///< of any class
    std::uint64_t bus_off = 0;             ///< times the controller went bus-off
    std::uint64_t restarted = 0;           ///< times it came back
    std::uint64_t interface_down = 0;      ///< times the interface went down or away
    std::uint64_t truncated = 0;           ///< reads of a size that is no frame
    std::uint64_t saturated_drains = 0;    ///< drains that ended at their bound with frames left to read
};

enum class SendResult : std::uint8_t {
    sent,       ///< handed to the controller's queue
    refused,    ///< no room now: dropped and counted
    bus_closed, ///< bus-off, or the interface is down
    invalid     ///< not a frame that this bus carries: see `is_well_formed`; CAN FD on a classic interface
};

/// A CAN bus as the rest of the program sees it: real (`SocketCanBus`) or a recording (`ReplayBus`). No call
/// blocks, allocates or throws once the bus is open, and each ends after a bounded number of steps.
/// - `drain(into)`: the frames that have arrived, in the order of arrival, at most `into.size()` of them, in
///   the returned part of `into`. Error frames are among them, already counted and reflected in `state()`.
/// - `send(frame)`: offers one frame.
/// - `now_ns()`: the clock on which frames are stamped; it never runs backward.
/// - `state()`, `counters()`: as of the last drain or send.
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
