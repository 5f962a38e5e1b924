// SPDX-License-Identifier: Apache-2.0
#pragma once

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
    std::uint8_t length = 0; ///< bytes of data: 0 … 8, or 0 … 8, 12, 16, 20, 24, 32, 48, 64 (CAN FD)
    Origin origin = Origin::remote;
    StampSource stamp_source = StampSource::arrival;
    std::array<std::uint8_t, 64> data{}; ///< bytes beyond `length` are zero
};

} // namespace dfdyn::hal
