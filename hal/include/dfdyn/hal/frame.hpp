// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <array>
#include <cstdint>

namespace dfdyn::hal {

/// Sender of a frame, from the point of view of the receiving bus object.
enum class Origin : std::uint8_t {
    remote,      ///< another node
    this_host,   ///< another program on this host (on Linux: MSG_DONTROUTE)
    this_socket, ///< this bus object itself (on Linux: MSG_CONFIRM)
};

/// The clock that stamped a frame.
enum class StampSource : std::uint8_t {
    hardware, ///< the controller, at reception
    kernel,   ///< the operating system, in its interrupt handler
    arrival,  ///< none: the time stamp is the time at which the program read the frame
    log,      ///< a recording
};

/// A frame of a classic CAN or CAN FD bus, or an error frame of its controller. 88 bytes.
struct Frame {
    std::int64_t stamp_ns = 0;          ///< time of reception on the clock of the bus (`Bus::now_ns`)
    std::uint32_t id = 0;               ///< 11 or 29 bits; in an error frame the bits of its error classes
    bool extended = false;              ///< 29-bit identifier
    bool remote = false;                ///< remote transmission request: no data
    bool error = false;                 ///< an error frame: see bus_event.hpp
    bool fd = false;                    ///< CAN FD: up to 64 bytes
    bool bit_rate_switch = false;       ///< CAN FD only
    bool error_state_indicator = false; ///< CAN FD only: the sender is error-passive
    /// bytes of data: 0 … 8, or 0 … 8, 12, 16, 20, 24, 32, 48, 64 (CAN FD); in a remote request the number of
    /// requested bytes
    std::uint8_t length = 0;
    Origin origin = Origin::remote;                  ///< the sender
    StampSource stamp_source = StampSource::arrival; ///< clock of `stamp_ns`
    std::array<std::uint8_t, 64> data{};             ///< bytes beyond `length` are zero
};

/// Returns true if a classic CAN frame, or a CAN FD frame, can have `length` bytes.
constexpr bool is_frame_length(std::uint32_t length, bool fd) noexcept {
    if (!fd || length <= 8) {
        return length <= 8;
    }
    return length <= 24 ? length % 4 == 0 : length == 32 || length == 48 || length == 64;
}

/// Returns true if a bus can carry `frame`, or a controller can report it as an error frame: its identifier
/// and length are in range, and no two flags contradict each other.
constexpr bool is_well_formed(const Frame& frame) noexcept {
    const bool wide = frame.extended || frame.error;
    const bool flags_agree =
        frame.fd ? !frame.remote && !frame.error : !frame.bit_rate_switch && !frame.error_state_indicator;
    const bool kinds_agree = !frame.error || (!frame.remote && !frame.extended);
    return flags_agree && kinds_agree && frame.id < (1U << (wide ? 29U : 11U)) &&
           is_frame_length(frame.length, frame.fd);
}

} // namespace dfdyn::hal
