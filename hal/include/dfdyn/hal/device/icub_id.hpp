// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal::icub {

/// Identifiers of the iCub's CAN protocol: message class (bits 10…8), address of the sender (7…4), and in
/// bits 3…0 the type of a periodic message or the destination of a polling message. Boards have addresses 1 …
/// 14; the host has address 0.
inline constexpr std::uint32_t periodic_motor_class = 0x100;
inline constexpr std::uint32_t polling_analog_class = 0x200;
inline constexpr std::uint32_t periodic_analog_class = 0x300;

[[nodiscard]] constexpr std::uint32_t identifier(std::uint32_t message_class, int address,
                                                 std::uint32_t type) noexcept {
    return message_class | (static_cast<std::uint32_t>(address) & 0xFU) << 4 | (type & 0xFU);
}

} // namespace dfdyn::hal::icub
