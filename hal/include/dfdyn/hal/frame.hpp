// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <array>
#include <cstdint>

namespace dfdyn::hal {

/// Where a frame came from, as seen by the receiving bus.
enum class Origin : std::uint8_t {
    remote,      ///< another node
    this_host,   ///< another program on this host (on Linux: MSG_DONTROUTE)
    this_socket, ///< this bus object itself (on Linux: MSG_CONFIRM)
};

/// Which clock stamped a frame.
enum class StampSource : std::uint8_t {
    hardware, ///< the controller, at reception
    kernel,   ///< the operating system, in its interrupt
    arrival,  ///< nobody: the stamp is the time at which the program read the frame
    log,      ///< a recording
};

/// One frame of a classic CAN or CAN FD bus, or an error frame of its controller; 88 bytes.
struct Frame {
    std::int64_t stamp_ns = 0;          ///< when it was received, on the bus' clock (`Bus::now_ns`)
    std::uint32_t id = 0;               ///< 11 or 29 bits; for an error frame: its error class bits
    bool extended = false;              ///< 29-bit identifier
    bool remote = false;                ///< remote transmission request: no data
    bool error = false;                 ///< an error frame: see bus_event.hpp
    bool fd = false;                    ///< CAN FD: up to 64 bytes
    bool bit_rate_switch = false;       ///< CAN FD only
    bool error_state_indicator = false; ///< CAN FD only: the sender is error-passive
    std::uint8_t length = 0; ///< bytes of data: 0 … 8, or 0 … 8, 12, 16, 20, 24, 32, 48, 64 (CAN FD); of a
                             ///< remote request: the bytes it asks for
    Origin origin = Origin::remote;
    StampSource stamp_source = StampSource::arrival;
    std::array<std::uint8_t, 64> data{}; ///< bytes beyond `length` are zero
};

/// Whether a frame of classic CAN, or of CAN FD, can have `length` bytes.
constexpr bool is_frame_length(std::uint32_t length, bool fd) noexcept {
    if (!fd || length <= 8) {
        return length <= 8;
    }
    return length <= 24 ? length % 4 == 0 : length == 32 || length == 48 || length == 64;
}

/// Whether `frame` is one that a bus can carry, or an error frame that a controller can report: identifier
/// and length in range, no flags that exclude each other.
constexpr bool is_well_formed(const Frame& frame) noexcept {
    const bool wide = frame.extended || frame.error;
    const bool flags_agree =
        frame.fd ? !frame.remote && !frame.error : !frame.bit_rate_switch && !frame.error_state_indicator;
    const bool kinds_agree = !frame.error || (!frame.remote && !frame.extended);
    return flags_agree && kinds_agree && frame.id < (1U << (wide ? 29U : 11U)) &&
           is_frame_length(frame.length, frame.fd);
}

} // namespace dfdyn::hal
