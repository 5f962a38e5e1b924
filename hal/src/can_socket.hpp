// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/socketcan_bus.hpp"

#include <cstdint>
#include <span>
#include <string>

namespace dfdyn::hal {

/// `filter` as the kernel's struct can_filter.
std::uint64_t kernel_filter(const IdFilter& filter) noexcept;

/// What opening a socket expected when it failed, and what the system said.
struct OpenFault {
    const char* expected = nullptr;
    int error_number = 0;
};

/// Opens a non-blocking socket on `options.interface`, with filters, error frames, CAN FD, stamps and drop
/// counts; -1 and `fault` where that fails. Does not allocate.
int open_can_socket(const SocketCanOptions& options, std::span<const std::uint64_t> filters,
                    OpenFault& fault) noexcept;

/// `fault` in words.
BusError open_error(const std::string& interface, const OpenFault& fault);

/// Whether the interface of this name is there and up. `descriptor`: any socket.
bool interface_is_up(int descriptor, const std::string& interface) noexcept;

} // namespace dfdyn::hal
