// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Kind of a host's command to a motor.
enum class MotorCommand : std::uint8_t {
    none,         ///< not a command to this motor
    control,      ///< a position, velocity, current or torque
    other_mode,   ///< perhaps the same in another mode; other devices may send it, too
    enable,       ///< run
    disable,      ///< stop
    set_zero,     ///< its present position becomes 0
    clear_faults, ///< forget its faults
    poll,         ///< report positions or efforts
    read,         ///< report a parameter or an identifier
    configure     ///< change a parameter or an identifier
};
inline constexpr int motor_command_count = 10;

} // namespace dfdyn::hal
