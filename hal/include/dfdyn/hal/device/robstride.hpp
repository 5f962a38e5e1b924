// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/mit_motor.hpp"

#include <numbers>

namespace dfdyn::hal {

/// A Robstride motor or a Xiaomi CyberGear with its own protocol ("private"). Layout:
/// belovictor/cybergear-docs, instructionmanual.md (17e371b), section 4.1. 29-bit identifiers: type (bits 28
/// … 24), data (23 … 8), target (7 … 0). By type:
/// - 2, feedback: mode (bits 23 and 22: 0 reset, 1 calibration, 2 run), faults (21 encoder not calibrated, 20
///   Hall sensor, 19 magnetic encoder, 18 temperature, 17 current, 16 voltage), motor (15 … 8), host (7 … 0).
///   Angle, velocity, torque and temperature (0.1 °C), u16 big-endian.
/// - 1, to the motor (bits 7 … 0): torque u16 in bits 23 … 8; angle, velocity, kp, kd, u16 big-endian.
/// - 3 enable, 4 stop (first byte 1: clears faults), 6 set zero, 17 read and 18 write a parameter: index u16
///   and value, little-endian, unlike the signals.
/// - 21, faults u32, in the bytes 0 … 3. The CyberGear manual has the host in bits 15 … 8 and the motor in 7
///   … 0; later manuals of Robstride exchange them. Both are accepted.
///
/// The angle saturates at ±4π (`position_out_of_range`). Answers to another host are ignored: two programs
/// that poll one motor get answers with different hosts. Positions and efforts carry `encoder_fault` or
/// `device_fault` with a fault bit, and `device_not_operational` in the modes reset and calibration. After a
/// fault frame they carry `device_fault` until one without faults, or until the motor leaves and enters the
/// mode run.
class RobstrideMotor {
  public:
    static constexpr int joints = 1;

    struct Config {
        int motor_id = 1;                           ///< 1 … 254
        int host_id = 0xFD;                         ///< 0 … 255: of the program that polls or commands
        int joint = 0;                              ///< joint of the arm, from 0
        double position_max = 4 * std::numbers::pi; ///< rad; LeRobot (1b8c2b6) rounds it to 12.57
        double velocity_max = 0;                    ///< rad/s
        double torque_max = 0;                      ///< N·m
        double motor_per_joint = 1; ///< ratio of a transmission behind the motor's own gear, with its sign
        double zero_rad = 0;        ///< position of the joint where the motor reports 0
    };

    /// Requires positive maxima.
    explicit constexpr RobstrideMotor(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    /// Returns false, because all its identifiers have 29 bits.
    [[nodiscard]] constexpr bool claims(std::uint32_t /*id*/) const noexcept { return false; }

    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        return is_private(frame) && (sender(frame) == motor_id() || target(frame) == motor_id());
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (!is_private(frame)) {
            return {};
        }
        if (type(frame) == feedback_type && sender(frame) == motor_id() && target(frame) == host_id()) {
            const Reason fault = check_form(frame, 8);
            return fault != Reason::ok ? rejected(fault) : decode_feedback(frame);
        }
        const bool of_motor = (sender(frame) == motor_id() && target(frame) == host_id()) ||
                              (sender(frame) == host_id() && target(frame) == motor_id());
        return type(frame) == fault_type && of_motor ? decode_faults(frame) : Decoded{};
    }

    /// Returns the temperature (°C) of a feedback.
    [[nodiscard]] static constexpr double temperature(const Frame& feedback) noexcept {
        return 0.1 * load_big<std::uint16_t>(feedback.data.data() + 6);
    }

    /// Encodes the feedback of a motor that runs without faults.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        Frame& frame = frames.frame[0];
        frame = new_frame(feedback_type, run << 14U | motor_id(), host_id());
        feedback_codes.encode(values[0], scale(), frame);
        return frames;
    }

    /// Encodes a joint torque command (N·m) without stiffness and damping, saturated to `torque_max`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        Frame torque = make_frame(0, 8);
        position_code.insert(torque_Nm / config_.motor_per_joint, config_.torque_max, torque);
        Frame frame = new_frame(control_type, load_big<std::uint16_t>(torque.data.data()), motor_id());
        position_code.insert(0, config_.position_max, frame);
        velocity_code.insert(0, config_.velocity_max, frame);
        return frame;
    }

    /// Decodes the joint torque command (N·m) to this motor. Returns nothing for any other frame, including
    /// commands with stiffness or damping.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (command(frame) != MotorCommand::control || frame.length != 8 ||
            load_big<std::uint32_t>(frame.data.data() + 4) != 0) {
            return std::nullopt;
        }
        const double share = data(frame) / position_code.largest();
        return (share * 2 * config_.torque_max - config_.torque_max) * config_.motor_per_joint;
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (!is_private(frame) || frame.remote || frame.fd || target(frame) != motor_id()) {
            return MotorCommand::none;
        }
        switch (type(frame)) {
        case 0:
        case 17:
            return MotorCommand::read;
        case control_type:
            return MotorCommand::control;
        case 3:
            return MotorCommand::enable;
        case 4:
            return frame.length > 0 && frame.data[0] == 1 ? MotorCommand::clear_faults
                                                          : MotorCommand::disable;
        case 6:
            return MotorCommand::set_zero;
        case 7:
        case 18:
        case 22:
            return MotorCommand::configure;
        default:
            return MotorCommand::none;
        }
    }

    /// Returns true for a feedback of this motor to a different host than the configured one.
    [[nodiscard]] static constexpr bool is_feedback_to_other(const Config& config,
                                                             const Frame& frame) noexcept {
        return is_private(frame) && type(frame) == feedback_type &&
               sender(frame) == static_cast<unsigned>(config.motor_id) &&
               target(frame) != static_cast<unsigned>(config.host_id);
    }

    /// Returns the motor that sent `frame` if it is an answer, or may be one: of types 0 and 17, requests
    /// have the host in its place. Returns nothing for other frames.
    [[nodiscard]] static constexpr std::optional<unsigned> answering_motor(const Frame& frame) noexcept {
        const bool may_answer = type(frame) == 0 || type(frame) == feedback_type || type(frame) == 17;
        return is_private(frame) && may_answer ? std::optional(sender(frame)) : std::nullopt;
    }

    /// Returns the identifier of a feedback without its mode and faults: that of a motor that runs without
    /// faults. Returns the identifier of any other frame unchanged.
    [[nodiscard]] static constexpr std::uint32_t stream_id(const Frame& frame) noexcept {
        constexpr std::uint32_t state_bits = 0xFF0000;
        return is_private(frame) && type(frame) == feedback_type ? (frame.id & ~state_bits) | run << 22U
                                                                 : frame.id;
    }

  private:
    static constexpr unsigned control_type = 1;
    static constexpr unsigned feedback_type = 2;
    static constexpr unsigned fault_type = 21;
    static constexpr unsigned run = 2;
    static constexpr unsigned encoder_bits = 0x38; ///< faults of calibration, Hall sensor, magnetic encoder

    static constexpr LinearCode position_code = big_endian_code(0, 16);
    static constexpr LinearCode velocity_code = big_endian_code(16, 16);
    static constexpr LinearFeedback feedback_codes{position_code, velocity_code, big_endian_code(32, 16)};

    [[nodiscard]] static constexpr bool is_private(const Frame& frame) noexcept {
        return frame.extended && !frame.error;
    }
    [[nodiscard]] static constexpr unsigned type(const Frame& frame) noexcept {
        return frame.id >> 24U & 0x1FU;
    }
    [[nodiscard]] static constexpr unsigned data(const Frame& frame) noexcept {
        return frame.id >> 8U & 0xFFFFU;
    }
    [[nodiscard]] static constexpr unsigned sender(const Frame& frame) noexcept {
        return frame.id >> 8U & 0xFFU;
    }
    [[nodiscard]] static constexpr unsigned target(const Frame& frame) noexcept { return frame.id & 0xFFU; }
    [[nodiscard]] constexpr unsigned motor_id() const noexcept {
        return static_cast<unsigned>(config_.motor_id);
    }
    [[nodiscard]] constexpr unsigned host_id() const noexcept {
        return static_cast<unsigned>(config_.host_id);
    }

    [[nodiscard]] static constexpr Frame new_frame(unsigned type, unsigned data, unsigned target) noexcept {
        Frame frame = make_frame(type << 24U | data << 8U | target, 8);
        frame.extended = true;
        return frame;
    }

    constexpr Decoded decode_faults(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        reported_fault_ = load_little<std::uint32_t>(frame.data.data()) != 0;
        return status(reported_fault_ ? Reason::device_fault : Reason::ok);
    }

    constexpr Reason condition_of(const Frame& frame) noexcept {
        const unsigned mode = frame.id >> 22U & 3U;
        const unsigned faults = frame.id >> 16U & 0x3FU;
        const bool starts = mode == run && !running_;
        running_ = mode == run;
        reported_fault_ = reported_fault_ && !(starts && heard_);
        heard_ = true;
        if ((faults & encoder_bits) != 0) {
            return Reason::encoder_fault;
        }
        if (faults != 0 || reported_fault_ || mode == 3) {
            return Reason::device_fault;
        }
        return running_ ? Reason::ok : Reason::device_not_operational;
    }

    [[nodiscard]] constexpr LinearScale scale() const noexcept {
        return {config_.joint,      config_.position_max,    config_.velocity_max,
                config_.torque_max, config_.motor_per_joint, config_.zero_rad};
    }

    constexpr Decoded decode_feedback(const Frame& frame) noexcept {
        return feedback_codes.decode(frame, scale(), condition_of(frame));
    }

    Config config_;
    bool running_ = false;
    bool heard_ = false;          ///< a feedback has arrived
    bool reported_fault_ = false; ///< the last fault frame had faults
};

static_assert(JointSource<RobstrideMotor>);

/// Robstride motors in MIT mode, as MitProtocol. Layout: huggingface/lerobot, robstride.py (024196a).
///
/// Byte 0 of a feedback is the motor number. Bytes 6 and 7 are one temperature, u16 big-endian, 0.1 °C
/// (Damiao: two of one byte). All motors answer on the identifier of the host, so that only byte 0 identifies
/// them; LeRobot checks nothing else. The protocol has no state. FF … FB clears faults; LeRobot's `sync_read`
/// sends it to read positions.
struct RobstrideMitProtocol : PlainMitProtocol {
    /// 25 °C
    static constexpr void mark_sound(Frame& feedback, unsigned motor) noexcept {
        feedback.data[0] = static_cast<std::uint8_t>(motor);
        store_big(feedback.data.data() + 6, std::uint16_t{250});
    }
    /// Returns the temperature (°C) of a feedback.
    [[nodiscard]] static constexpr double temperature(const Frame& feedback) noexcept {
        return RobstrideMotor::temperature(feedback);
    }
};

using RobstrideMitMotor = MitMotor<RobstrideMitProtocol>;
static_assert(JointSource<RobstrideMitMotor>);

} // namespace dfdyn::hal
