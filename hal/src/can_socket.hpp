// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/socketcan_bus.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace dfdyn::hal {

/// Converts `filter` to the bytes of the kernel's struct can_filter.
std::uint64_t kernel_filter(const IdFilter& filter) noexcept;

/// Failure to open a socket: what was expected, and the error number of the system.
struct OpenFault {
    const char* expected = nullptr;
    int error_number = 0;
};

/// Opens a non-blocking socket on `options.interface` with filters, error frames, CAN FD, time stamps and
/// drop counts. Returns its descriptor, or -1 with `fault` filled in. Does not allocate.
int open_can_socket(const SocketCanOptions& options, std::span<const std::uint64_t> filters,
                    OpenFault& fault) noexcept;

/// Formats `fault` as an error message.
BusError open_error(const std::string& interface, const OpenFault& fault);

/// Returns true if an interface of this name exists and is up. `descriptor`: any socket.
bool interface_is_up(int descriptor, const std::string& interface) noexcept;

} // namespace dfdyn::hal
