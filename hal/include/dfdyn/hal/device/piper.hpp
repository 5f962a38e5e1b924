// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/linear_code.hpp"
#include "dfdyn/hal/device/motor_command.hpp"

#include <numbers>
#include <optional>

namespace dfdyn::hal {

/// Firmware of an AgileX Piper. Versions use the same identifiers with other contents.
enum class PiperFirmware : std::uint8_t {
    any,    ///< current units; ignores the bits whose meaning changed on 2024-07-25
    rpm,    ///< old: speeds in rpm, currents in 0.1 A; ignores these bits
    current ///< since 2024-07-25: the status bits are those of collision and stall
};

/// Two neighbouring joints of an AgileX Piper, which share a frame. Layout: agilexrobotics/piper_sdk
/// (1dadd60), protocol_v2 and msg_v2. Classic frames of 8 bytes, big-endian, sent without a request. By
/// identifier, with the first pair's numbers; k is the joint, 1 … 6:
/// - 0x2A5 (0x2A6, 0x2A7): angles of two joints, i32, 0.001 °. The arm measures the three frames at different
///   times.
/// - 0x250 + k: speed i16 (0.001 rad/s), current i16 (0.001 A), position i32. The document specifies an
///   unsigned current; the SDK decodes a signed one, and so does this class.
/// - 0x260 + k: voltage, temperatures, status (byte 5), supply current, which is always 0 for the small
///   motors. Status bits: 0 voltage, 1 motor temperature, 2 current, 3 driver temperature, 5 driver fault, 6
///   enabled; 4 collision and 7 stall since 2024-07-25, sensor and homing before.
/// - 0x2A1: state of the arm; byte 7 has a bit for each joint that does not communicate.
/// - 0x159 + k, to the arm: like the MIT mode, but torque u8 and a 4-bit checksum (XOR of the other bytes).
///
/// A second arm on the bus sends on 0x2B1 or 0x2C1 instead of 0x2A1, and on the seven that follow.
///
/// Efforts are currents. The SDK's "effort" is the current times 1.18125 (joints 1 to 3) or 0.95844 N·m/A.
/// The SDK scales a commanded torque to ±8 N·m; its documentation has ±18.
///
/// Values carry `encoder_fault` while the arm does not hear the joint, `device_fault` with a status bit,
/// `device_not_operational` while the drive is not enabled.
class PiperPair {
  public:
    static constexpr int joints = 2;

    struct Config {
        int pair = 0;                      ///< 0: joints 1 and 2 of the Piper; 0 … 2
        std::array<int, 2> joint{0, 1};    ///< joints of the arm, from 0; `unused_joint`
        std::array<double, 2> sign{1, 1};  ///< -1: the joint counts in the other direction
        std::array<double, 2> zero_rad{};  ///< position of the joint where the arm reports 0
        std::uint32_t feedback_id = 0x2A1; ///< 0x2B1, 0x2C1 for a moved range
        std::uint32_t driver_id = 0x251;   ///< of joint 1's speed and current; its status is 16 further
        PiperFirmware firmware = PiperFirmware::any;
        bool torque = false;           ///< efforts in N·m, by the SDK's factors
        double torque_command_max = 8; ///< N·m
    };

    explicit constexpr PiperPair(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == angles_id() || half_of(id, config_.driver_id) >= 0 ||
               half_of(id, config_.driver_id + status_offset) >= 0;
    }

    /// The first pair also represents the arm as a whole, and its commands.
    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        if (frame.error || frame.extended) {
            return false;
        }
        const bool of_arm = (frame.id >= config_.feedback_id && frame.id < config_.feedback_id + 8) ||
                            (frame.id >= 0x481 && frame.id <= 0x486) ||
                            (frame.id >= 0x150 && frame.id <= 0x15F) ||
                            (frame.id >= 0x470 && frame.id <= 0x47F);
        return claims(frame.id) || (config_.pair == 0 && of_arm);
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        const bool mine =
            !frame.error && !frame.extended && (claims(frame.id) || frame.id == config_.feedback_id);
        if (!mine) {
            return {};
        }
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        if (frame.id == angles_id()) {
            return decode_angles(frame);
        }
        if (frame.id == config_.feedback_id) {
            return decode_arm(frame);
        }
        const int fast = half_of(frame.id, config_.driver_id);
        return fast >= 0 ? decode_current(frame, static_cast<std::size_t>(fast))
                         : decode_status(frame, static_cast<std::size_t>(
                                                    half_of(frame.id, config_.driver_id + status_offset)));
    }

    /// Encodes the angles, and speed and current of each joint.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 2>& values) const noexcept {
        FrameList frames;
        frames.frame[0] = make_frame(angles_id(), 8);
        frames.count = 1;
        for (std::size_t i = 0; i < 2; ++i) {
            const JointValue& value = values[i];
            const double angle = (value.position_rad - config_.zero_rad[i]) * config_.sign[i];
            store_big(frames.frame[0].data.data() + 4 * i, saturated<std::int32_t>(angle / angle_step));
            Frame& fast = frames.frame[static_cast<std::size_t>(frames.count++)];
            fast = make_frame(config_.driver_id + first() + static_cast<std::uint32_t>(i), 8);
            const double speed = value.has_velocity ? value.velocity * config_.sign[i] : 0;
            store_big(fast.data.data(), saturated<std::int16_t>(speed / speed_step()));
            store_big(fast.data.data() + 2, saturated<std::int16_t>(value.effort / effort_step(i)));
        }
        return frames;
    }

    /// Encodes a torque (N·m) of joint `half` (0 or 1) of the pair, without stiffness and damping.
    [[nodiscard]] Frame encode_torque(int half, double torque_Nm) const noexcept {
        const auto i = static_cast<std::size_t>(half);
        Frame frame = make_frame(command_id(i), 8);
        commanded_position.insert(0, 12.5, frame);
        commanded_velocity.insert(0, 45, frame);
        commanded_damping.insert(0, 5, frame);
        commanded_torque.insert(torque_Nm * config_.sign[i], config_.torque_command_max, frame);
        frame.data[7] = static_cast<std::uint8_t>((frame.data[7] & 0xF0U) | check_sum(frame));
        return frame;
    }

    /// Decodes the torque (N·m) that `frame` commands to joint `half`. Returns nothing for any other frame.
    [[nodiscard]] constexpr std::optional<double> decode_torque(int half, const Frame& frame) const noexcept {
        const auto i = static_cast<std::size_t>(half);
        const bool form = has_id(frame, command_id(i)) && check_form(frame, 8) == Reason::ok &&
                          (frame.data[7] & 0xFU) == check_sum(frame);
        if (!form || commanded_stiffness.extract_raw({frame.data.data(), 8}) != 0 ||
            magnitude(commanded_damping.value(frame, 5)) > commanded_damping.step(5)) {
            return std::nullopt;
        }
        return commanded_torque.value(frame, config_.torque_command_max) * config_.sign[i];
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (frame.error || frame.extended || frame.remote) {
            return MotorCommand::none;
        }
        if (frame.id >= 0x150 && frame.id <= 0x15F) {
            return MotorCommand::control;
        }
        switch (frame.id) {
        case 0x471:
            return frame.length > 1 && frame.data[1] == 2 ? MotorCommand::enable : MotorCommand::disable;
        case 0x472:
        case 0x477:
            return MotorCommand::read;
        case 0x475: // byte 1: 0xAE sets the zero; byte 5: 0xAE clears the error
            return frame.length > 1 && frame.data[1] == 0xAE   ? MotorCommand::set_zero
                   : frame.length > 5 && frame.data[5] == 0xAE ? MotorCommand::clear_faults
                                                               : MotorCommand::configure;
        case 0x470:
        case 0x474:
        case 0x479:
        case 0x47A:
        case 0x47D:
            return MotorCommand::configure;
        default:
            return MotorCommand::none;
        }
    }

  private:
    static constexpr std::uint32_t status_offset = 0x10;
    static constexpr double angle_step = 0.001 * std::numbers::pi / 180; ///< rad
    static constexpr std::uint8_t enabled_bit = 0x40;
    static constexpr std::uint8_t fault_bits = 0x2F;
    static constexpr std::uint8_t newer_fault_bits = 0x90; ///< collision, stall

    static constexpr LinearCode commanded_position = big_endian_code(0, 16);
    static constexpr LinearCode commanded_velocity = big_endian_code(16, 12);
    static constexpr Signal commanded_stiffness = big_endian_code(28, 12).signal;
    static constexpr LinearCode commanded_damping = big_endian_code(40, 12);
    static constexpr LinearCode commanded_torque = big_endian_code(52, 8);

    [[nodiscard]] static constexpr std::uint8_t check_sum(const Frame& frame) noexcept {
        std::uint8_t sum = 0;
        for (std::size_t i = 0; i < 7; ++i) {
            sum = static_cast<std::uint8_t>(sum ^ frame.data[i]);
        }
        return sum & 0xFU;
    }

    /// The first of the two joints, from 0, in the Piper's own order.
    [[nodiscard]] constexpr std::uint32_t first() const noexcept {
        return 2 * static_cast<std::uint32_t>(config_.pair);
    }
    [[nodiscard]] constexpr std::uint32_t angles_id() const noexcept {
        return config_.feedback_id + 4 + static_cast<std::uint32_t>(config_.pair);
    }
    [[nodiscard]] constexpr std::uint32_t command_id(std::size_t half) const noexcept {
        return 0x15A + first() + static_cast<std::uint32_t>(half);
    }
    /// Returns the joint of the pair with this identifier in the six from `base`; -1: none.
    [[nodiscard]] constexpr int half_of(std::uint32_t id, std::uint32_t base) const noexcept {
        return id == base + first() ? 0 : id == base + first() + 1 ? 1 : -1;
    }

    [[nodiscard]] constexpr double speed_step() const noexcept {
        return config_.firmware == PiperFirmware::rpm ? std::numbers::pi / 30 : 0.001;
    }
    /// N·m or A for one count of the current.
    [[nodiscard]] constexpr double effort_step(std::size_t half) const noexcept {
        const double ampere = config_.firmware == PiperFirmware::rpm ? 0.1 : 0.001;
        const double factor = !config_.torque ? 1 : first() + half < 3 ? 1.18125 : 0.95844;
        return ampere * factor * config_.sign[half];
    }

    [[nodiscard]] static constexpr Decoded values(int count) noexcept {
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = count;
        return decoded;
    }

    [[nodiscard]] constexpr Decoded decode_angles(const Frame& frame) const noexcept {
        Decoded decoded = values(2);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto counts = load_big<std::int32_t>(frame.data.data() + 4 * i);
            JointValue& value = decoded.joint[i];
            value.joint = config_.joint[i];
            value.stamp_ns = frame.stamp_ns;
            value.from_zero_rad = counts * angle_step * config_.sign[i];
            value.position_rad = value.from_zero_rad + config_.zero_rad[i];
            value.step_rad = angle_step;
            value.raw_zero = counts == 0;
            value.position_reason = condition(i) != Reason::ok ? condition(i)
                                    : is_at_end(counts)        ? Reason::position_out_of_range
                                                               : Reason::ok;
        }
        return decoded;
    }

    [[nodiscard]] constexpr Decoded decode_current(const Frame& frame, std::size_t half) const noexcept {
        Decoded decoded = values(1);
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint[half];
        value.stamp_ns = frame.stamp_ns;
        value.has_velocity = true;
        value.velocity = load_big<std::int16_t>(frame.data.data()) * speed_step() * config_.sign[half];
        const auto current = load_big<std::int16_t>(frame.data.data() + 2);
        value.effort = current * effort_step(half);
        value.effort_reason = condition(half) != Reason::ok ? condition(half)
                              : is_at_end(current)          ? Reason::output_saturated
                                                            : Reason::ok;
        return decoded;
    }

    constexpr Decoded decode_status(const Frame& frame, std::size_t half) noexcept {
        const std::uint8_t bits = frame.data[5];
        const std::uint8_t faults = static_cast<std::uint8_t>(
            fault_bits | (config_.firmware == PiperFirmware::current ? newer_fault_bits : 0U));
        drive_[half] = (bits & faults) != 0        ? Reason::device_fault
                       : (bits & enabled_bit) != 0 ? Reason::ok
                                                   : Reason::device_not_operational;
        return status(condition(half));
    }

    constexpr Decoded decode_arm(const Frame& frame) noexcept {
        for (std::size_t i = 0; i < 2; ++i) {
            unheard_[i] = (frame.data[7] >> (first() + i) & 1U) != 0;
        }
        return status(condition(0) != Reason::ok ? condition(0) : condition(1));
    }

    [[nodiscard]] constexpr Reason condition(std::size_t half) const noexcept {
        return unheard_[half] ? Reason::encoder_fault : drive_[half];
    }

    Config config_;
    std::array<bool, 2> unheard_{};                       ///< the arm reports that it does not communicate
    std::array<Reason, 2> drive_{Reason::ok, Reason::ok}; ///< from its last status; ok before the first
};

static_assert(JointSource<PiperPair>);

} // namespace dfdyn::hal
