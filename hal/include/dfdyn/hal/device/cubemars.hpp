// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/mit_motor.hpp"

#include <numbers>

namespace dfdyn::hal {

/// CubeMars (T-Motor) AK motors in MIT mode, as MitProtocol. Layout: neurobionics/TMotorCANControl,
/// mit_can.py (bb8d071).
///
/// Byte 0 of a feedback is the motor number, byte 6 the temperature (°C), byte 7 an error: 0 none. Old
/// firmware sends six bytes, without temperature and error. All motors answer on identifier 0, unless it was
/// changed. The torque is the current times a constant, without friction. TMotorCANControl measured 0.115
/// N·m/A for the AK80-9, 26 % more than the maker's 0.091. Values carry `device_fault` with any error,
/// documented or not.
struct CubemarsMitProtocol : PlainMitProtocol {
    [[nodiscard]] static constexpr bool has_length(int length) noexcept { return length == 6 || length == 8; }
    [[nodiscard]] static constexpr Reason condition(const Frame& feedback) noexcept {
        return feedback.length < 8 || feedback.data[7] == 0 ? Reason::ok : Reason::device_fault;
    }
    /// 25 °C
    static constexpr void mark_sound(Frame& feedback, unsigned motor) noexcept {
        feedback.data[0] = static_cast<std::uint8_t>(motor);
        feedback.data[6] = 25;
    }
};

using CubemarsMitMotor = MitMotor<CubemarsMitProtocol>;
static_assert(JointSource<CubemarsMitMotor>);

/// A CubeMars (T-Motor) AK motor in servo mode. Layout: neurobionics/TMotorCANControl, servo_can.py
/// (bb8d071). 29-bit identifiers: packet (bits 28 … 8), motor (7 … 0); big-endian. By packet:
/// - 0x29, 8 bytes, feedback: position i16 (0.1 °), speed i16 (10 electrical rpm), current i16 (0.01 A),
///   temperature i8 (°C), error u8. Some firmware has another packet number or none.
/// - 0 … 8, to the motor: 1 is a current, i32 (0.001 A).
///
/// Values carry `encoder_fault` with error 5, `device_fault` with any other. Positions end at ±3200 °.
class CubemarsServo {
  public:
    static constexpr int joints = 1;

    struct Config {
        int motor_id = 1;                   ///< 0 … 255
        int packet = -1;                    ///< of the feedback; -1: any packet that is not a command
        int joint = 0;                      ///< joint of the arm, from 0
        double pole_pairs = 21;             ///< of the motor: electrical per mechanical revolutions
        double gear_ratio = 9;              ///< motor revolutions per revolution of the reported position
        double newton_metre_per_ampere = 0; ///< of the motor's output; 0: efforts are currents (A)
        double motor_per_joint = 1; ///< ratio of a transmission behind the motor's own gear, with its sign
        double zero_rad = 0;        ///< position of the joint where the motor reports 0
    };

    explicit constexpr CubemarsServo(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    /// Returns false, because all its identifiers have 29 bits.
    [[nodiscard]] constexpr bool claims(std::uint32_t /*id*/) const noexcept { return false; }

    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        return is_feedback(frame) || command(frame) != MotorCommand::none;
    }

    [[nodiscard]] constexpr Decoded decode(const Frame& frame) const noexcept {
        if (!is_feedback(frame)) {
            return {};
        }
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const std::uint8_t error = frame.data[7];
        const Reason condition = error == 0               ? Reason::ok
                                 : error == encoder_error ? Reason::encoder_fault
                                                          : Reason::device_fault;
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        value.stamp_ns = frame.stamp_ns;
        const auto position = load_big<std::int16_t>(frame.data.data());
        const auto speed = load_big<std::int16_t>(frame.data.data() + 2);
        const auto current = load_big<std::int16_t>(frame.data.data() + 4);
        value.from_zero_rad = position * position_step / config_.motor_per_joint;
        value.position_rad = value.from_zero_rad + config_.zero_rad;
        value.step_rad = magnitude(position_step / config_.motor_per_joint);
        value.raw_zero = position == 0;
        value.has_velocity = true;
        value.velocity = speed * velocity_step() / config_.motor_per_joint;
        const bool at_end = position >= last_position || position <= -last_position;
        value.position_reason = condition != Reason::ok ? condition
                                : at_end                ? Reason::position_out_of_range
                                                        : Reason::ok;
        value.effort = current * effort_step();
        value.effort_reason = condition != Reason::ok ? condition
                              : is_at_end(current)    ? Reason::output_saturated
                                                      : Reason::ok;
        return decoded;
    }

    /// Encodes the feedback of a motor without errors.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        Frame& frame = frames.frame[0];
        frame = new_frame(config_.packet < 0 ? usual_packet : static_cast<unsigned>(config_.packet), 8);
        const JointValue& value = values[0];
        const double motor_rad = (value.position_rad - config_.zero_rad) * config_.motor_per_joint;
        const double speed = value.has_velocity ? value.velocity * config_.motor_per_joint : 0;
        store_big(frame.data.data(), saturated<std::int16_t>(motor_rad / position_step));
        store_big(frame.data.data() + 2, saturated<std::int16_t>(speed / velocity_step()));
        store_big(frame.data.data() + 4, saturated<std::int16_t>(value.effort / effort_step()));
        frame.data[6] = 25; // °C
        return frames;
    }

    /// Encodes the current for a joint torque (N·m). Requires `newton_metre_per_ampere`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        Frame frame = new_frame(current_packet, 4);
        store_big(frame.data.data(), saturated<std::int32_t>(torque_Nm / (effort_step() * command_step)));
        return frame;
    }

    /// Decodes the joint torque command (N·m) to this motor. Returns nothing for any other frame.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (!is_to_motor(frame) || packet(frame) != current_packet || check_form(frame, 4) != Reason::ok) {
            return std::nullopt;
        }
        return load_big<std::int32_t>(frame.data.data()) * effort_step() * command_step;
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (!is_to_motor(frame) || frame.remote || frame.fd || packet(frame) > last_command) {
            return MotorCommand::none;
        }
        if (packet(frame) == 0 && frame.length == 8) {
            return MotorCommand::none; // a feedback without packet number
        }
        return packet(frame) == 5 ? MotorCommand::set_zero : MotorCommand::control;
    }

  private:
    static constexpr unsigned usual_packet = 0x29;
    static constexpr unsigned current_packet = 1;
    static constexpr unsigned last_command = 8;
    static constexpr std::uint8_t encoder_error = 5;
    static constexpr int last_position = 32'000;                          ///< counts
    static constexpr double position_step = 0.1 * std::numbers::pi / 180; ///< rad
    static constexpr double current_step = 0.01;                          ///< A
    static constexpr double command_step = 0.1; ///< of a commanded current, in counts of a measured one

    [[nodiscard]] constexpr double velocity_step() const noexcept {
        return 10 * 2 * std::numbers::pi / 60 / (config_.pole_pairs * config_.gear_ratio);
    }
    [[nodiscard]] constexpr double effort_step() const noexcept {
        const bool torque = config_.newton_metre_per_ampere != 0;
        return current_step * (torque ? config_.newton_metre_per_ampere * config_.motor_per_joint
                                      : (config_.motor_per_joint < 0 ? -1 : 1));
    }

    [[nodiscard]] static constexpr unsigned packet(const Frame& frame) noexcept { return frame.id >> 8U; }
    [[nodiscard]] constexpr bool is_to_motor(const Frame& frame) const noexcept {
        return frame.extended && !frame.error &&
               (frame.id & 0xFFU) == static_cast<unsigned>(config_.motor_id);
    }
    [[nodiscard]] constexpr bool is_feedback(const Frame& frame) const noexcept {
        if (!is_to_motor(frame)) {
            return false;
        }
        if (config_.packet >= 0) {
            return packet(frame) == static_cast<unsigned>(config_.packet);
        }
        const unsigned number = packet(frame);
        return number == usual_packet || (number == 0 && frame.length == 8) || number == 9;
    }

    [[nodiscard]] constexpr Frame new_frame(unsigned packet, int length) const noexcept {
        Frame frame = make_frame(packet << 8U | static_cast<unsigned>(config_.motor_id), length);
        frame.extended = true;
        return frame;
    }

    Config config_;
};

static_assert(JointSource<CubemarsServo>);

} // namespace dfdyn::hal
