// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::hal {

/// Kind of a host's command to a motor.
enum class MotorCommand : std::uint8_t {
    none,         ///< not a command to this motor
    control,      ///< a position, velocity, current or torque
    enable,       ///< run
    disable,      ///< stop
    set_zero,     ///< its present position becomes 0
    clear_faults, ///< forget its faults
    poll,         ///< report values or a parameter
    configure     ///< change a parameter or an identifier
};
inline constexpr int motor_command_count = 8;

} // namespace dfdyn::hal
