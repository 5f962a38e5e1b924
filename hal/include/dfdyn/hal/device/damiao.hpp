// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/mit_motor.hpp"

namespace dfdyn::hal {

/// Damiao DM motors, as MitProtocol. Layout: otegami/openarm, motor-can.md; enactic/openarm_can (98666042),
/// dm_motor_control.cpp.
///
/// - Byte 0 of a feedback is state and motor id (nibbles), bytes 6 and 7 are the temperatures (°C) of
///   transistors and rotor. `feedback_id` is register MST_ID, `motor_id` (1 … 15) register ESC_ID.
/// - Answers about registers also come on `feedback_id`: motor id u16, 0x33 (read), 0x55 (written) or 0xAA
///   (saved), register number, value (float), little-endian. Registers 21, 22 and 23 are the maxima of
///   position, velocity and torque. The first byte is the motor id, as in the feedback of a disabled motor;
///   the next two bytes distinguish the two.
/// - 0x7FF, to all motors: register access, or 0xCC, which requests a feedback.
///
/// Two widely used libraries disagree about the default maxima. LeRobot (06f4bd2) has 8 rad/s for the DM4340,
/// openarm_can (98666042) 10 rad/s. For the DM3507 they have 30 and 50 rad/s, 10 and 5 N·m.
///
/// Values carry `device_not_operational` while the motor is disabled. They carry `device_fault` in any other
/// state except enabled, documented or not.
struct DamiaoProtocol {
    [[nodiscard]] static constexpr unsigned motor_of(const Frame& frame) noexcept {
        return frame.data[0] & 0xFU;
    }
    [[nodiscard]] static constexpr bool has_length(int length) noexcept { return length == 8; }

    [[nodiscard]] static constexpr Reason condition(const Frame& feedback) noexcept {
        const unsigned state = feedback.data[0] >> 4U;
        return state == enabled    ? Reason::ok
               : state == disabled ? Reason::device_not_operational
                                   : Reason::device_fault;
    }

    /// Returns false for a register reply to any program, and for a request that comes back on this
    /// identifier.
    [[nodiscard]] static constexpr bool is_feedback(const Frame& frame, unsigned motor) noexcept {
        const std::uint8_t what = frame.data[2];
        return frame.data[0] != motor || frame.data[1] != 0 ||
               !(what == read || what == written || what == 0xAA || what == 0xCC);
    }

    [[nodiscard]] static constexpr std::optional<ReportedMaximum> reported(const Frame& answer) noexcept {
        const int maximum = answer.data[3] - first_maximum;
        if ((answer.data[2] != read && answer.data[2] != written) || maximum < 0 || maximum > 2) {
            return std::nullopt;
        }
        return ReportedMaximum{maximum, static_cast<double>(load_little<float>(answer.data.data() + 4))};
    }

    static constexpr void mark_sound(Frame& feedback, unsigned motor) noexcept {
        feedback.data[0] = static_cast<std::uint8_t>(enabled << 4U | motor);
    }

    /// Other modes have the identifiers motor + 0x100 (position and velocity, 8 bytes), 0x200 (velocity, 4
    /// bytes, padded to 8 by some programs) and 0x300 (position and limits, 8 bytes). These may be PDOs of
    /// CANopen drives, too; frames of other lengths are. 0x7FF has the motor in bytes 0 and 1.
    [[nodiscard]] static constexpr MotorCommand other_command(const Frame& frame, unsigned motor) noexcept {
        if (frame.error || frame.extended || frame.remote) {
            return MotorCommand::none;
        }
        const std::uint32_t mode = frame.id - motor;
        if (mode == 0x100 || mode == 0x200 || mode == 0x300) {
            const bool has_length = frame.length == 8 || (mode == 0x200 && frame.length == 4);
            return has_length ? MotorCommand::other_mode : MotorCommand::none;
        }
        if (frame.id != 0x7FF || frame.length < 4 || frame.data[0] != motor || frame.data[1] != 0) {
            return MotorCommand::none;
        }
        return frame.data[2] == 0xCC   ? MotorCommand::poll
               : frame.data[2] == read ? MotorCommand::read
                                       : MotorCommand::configure;
    }

  private:
    static constexpr unsigned enabled = 1;
    static constexpr unsigned disabled = 0;
    static constexpr std::uint8_t read = 0x33;
    static constexpr std::uint8_t written = 0x55;
    static constexpr int first_maximum = 21; ///< register of the position's maximum
};

using DamiaoMotor = MitMotor<DamiaoProtocol>;
static_assert(JointSource<DamiaoMotor>);

} // namespace dfdyn::hal
