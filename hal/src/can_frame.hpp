// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstddef>
#include <cstdint>
#include <ctime>

#include <linux/can.h>
#include <sys/socket.h>

namespace dfdyn::hal {

inline std::int64_t nanoseconds(const timespec& time) noexcept {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Decodes the first `size` bytes of `raw`, a classic or FD frame, into `frame`, which must be empty.
void decode_can_frame(const canfd_frame& raw, std::size_t size, Frame& frame) noexcept;

/// Converts a well-formed frame to the kernel's format. For a classic frame, use the first CAN_MTU bytes.
canfd_frame encode_can_frame(const Frame& frame) noexcept;

/// Returns the sender of a frame according to the flags of its message.
Origin origin_of(int message_flags) noexcept;

/// Ancillary data received with a frame.
struct Ancillary {
    std::int64_t software_ns = 0; ///< 0: none
    std::int64_t hardware_ns = 0; ///< 0: none
    std::uint32_t drops = 0;
    bool has_drops = false;
};

Ancillary ancillary_of(const msghdr& message) noexcept;

} // namespace dfdyn::hal
