// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/linear_code.hpp"
#include "dfdyn/hal/device/motor_command.hpp"

#include <concepts>
#include <optional>

namespace dfdyn::hal {

/// A maximum that a motor reports. `maximum`: 0 position, 1 velocity, 2 torque.
struct ReportedMaximum {
    int maximum = 0;
    double value = 0;
};

/// Base of protocols with feedback as the only answer, without a state, and with the commands of MIT mode
/// only.
struct PlainMitProtocol {
    [[nodiscard]] static constexpr unsigned motor_of(const Frame& frame) noexcept { return frame.data[0]; }
    [[nodiscard]] static constexpr bool has_length(int length) noexcept { return length == 8; }
    [[nodiscard]] static constexpr Reason condition(const Frame& /*feedback*/) noexcept { return Reason::ok; }
    [[nodiscard]] static constexpr bool is_feedback(const Frame& /*frame*/, unsigned /*motor*/) noexcept {
        return true;
    }
    [[nodiscard]] static constexpr std::optional<ReportedMaximum> reported(const Frame& /*answer*/) noexcept {
        return std::nullopt;
    }
    [[nodiscard]] static constexpr MotorCommand other_command(const Frame& /*frame*/,
                                                              unsigned /*motor*/) noexcept {
        return MotorCommand::none;
    }
};

/// Differences between the motors with MIT mode, all static:
/// - `motor_of(frame)`: the motor number in byte 0 of an answer.
/// - `has_length(length)`: lengths of a feedback.
/// - `condition(feedback)`: the motor's own state; ok if the protocol has none.
/// - `is_feedback(frame, motor)`: false for other answers on the same identifier.
/// - `reported(frame)`: the maximum that such an answer reports, or nothing.
/// - `mark_sound(frame, motor)`: writes byte 0 and the state of a motor without faults.
/// - `other_command(frame, motor)`: a command to the motor that the MIT mode does not have.
template <class P>
concept MitProtocol = requires(const Frame& frame, Frame& sent, unsigned motor, int length) {
    { P::motor_of(frame) }
    noexcept->std::same_as<unsigned>;
    { P::has_length(length) }
    noexcept->std::same_as<bool>;
    { P::condition(frame) }
    noexcept->std::same_as<Reason>;
    { P::is_feedback(frame, motor) }
    noexcept->std::same_as<bool>;
    { P::reported(frame) }
    noexcept->std::same_as<std::optional<ReportedMaximum>>;
    { P::mark_sound(sent, motor) }
    noexcept;
    { P::other_command(frame, motor) }
    noexcept->std::same_as<MotorCommand>;
};

/// A motor with the frames of the MIT Cheetah's motor controller ("MIT mode"), which many makers use. Frames
/// by standard identifier, on classic CAN or CAN FD, big-endian:
/// - `feedback_id`, feedback: byte 0 motor number (see `Protocol`), position u16, velocity u12, torque u12,
///   bytes 6 and 7 temperatures or state (see `Protocol`).
/// - `motor_id`, to the motor: position u16, velocity u12, kp u12, kd u12, torque u12; or seven bytes FF and
///   FC (enable), FD (disable), FE (set zero), FB (clear faults).
///
/// Some firmware answers on `motor_id`. A command with a position near -position_max then looks like an
/// answer.
///
/// The frames do not contain the maxima of the codes. If a motor reports a maximum that differs from
/// `Config`, the values that depend on it carry `full_scale_contradicted` until the two agree.
///
/// A position at an end of its code carries `position_out_of_range`, a torque `output_saturated`.
template <MitProtocol Protocol>
class MitMotor {
  public:
    static constexpr int joints = 1;

    struct Config {
        int motor_id = 1;
        std::uint32_t feedback_id = 0x11;
        int joint = 0;              ///< joint of the arm, from 0
        double position_max = 0;    ///< rad
        double velocity_max = 0;    ///< rad/s
        double torque_max = 0;      ///< N·m
        double motor_per_joint = 1; ///< ratio of a transmission behind the motor's own gear, with its sign
        double zero_rad = 0;        ///< position of the joint where the motor reports 0
        bool shared_feedback_id = false; ///< other motors answer on it; byte 0 identifies them
        bool fd = false;                 ///< `encode` and `encode_torque` make CAN FD frames
    };

    /// Requires positive maxima.
    explicit constexpr MitMotor(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return !config_.shared_feedback_id && id == config_.feedback_id;
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (!has_id(frame, config_.feedback_id)) {
            return {};
        }
        if (const Reason fault = check_message(frame); fault != Reason::ok) {
            return rejected(fault);
        }
        if (Protocol::motor_of(frame) != motor_id()) { // another motor with the same feedback_id
            return config_.shared_feedback_id || answers_on_own_id() ? Decoded{}
                                                                     : rejected(Reason::id_collision);
        }
        return Protocol::is_feedback(frame, motor_id()) ? decode_feedback(frame) : decode_report(frame);
    }

    /// Encodes the feedback of a motor without faults.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        Frame& frame = frames.frame[0];
        frame = new_frame(config_.feedback_id);
        Protocol::mark_sound(frame, motor_id());
        feedback_codes.encode(values[0], scale(), frame);
        return frames;
    }

    /// Encodes a joint torque command (N·m) without stiffness and damping, saturated to `torque_max`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        Frame frame = new_frame(motor_id());
        commanded_position.insert(0, config_.position_max, frame);
        commanded_velocity.insert(0, config_.velocity_max, frame);
        commanded_torque.insert(torque_Nm / config_.motor_per_joint, config_.torque_max, frame);
        return frame;
    }

    /// Decodes the joint torque command (N·m) to this motor. Returns nothing for any other frame, including
    /// commands with stiffness or damping and those to enable or disable the motor.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (command(frame) != MotorCommand::control || frame.id != motor_id() ||
            commanded_gains.extract_raw({frame.data.data(), 8}) != 0) {
            return std::nullopt;
        }
        return commanded_torque.value(frame, config_.torque_max) * config_.motor_per_joint;
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (!has_id(frame, motor_id()) || frame.remote || frame.length != 8) {
            return Protocol::other_command(frame, motor_id());
        }
        if (answers_on_own_id() && Protocol::motor_of(frame) == motor_id()) {
            return MotorCommand::none; // its answer
        }
        for (std::size_t i = 0; i < 7; ++i) {
            if (frame.data[i] != 0xFF) {
                return MotorCommand::control;
            }
        }
        switch (frame.data[7]) {
        case 0xFB:
            return MotorCommand::clear_faults;
        case 0xFC:
            return MotorCommand::enable;
        case 0xFD:
            return MotorCommand::disable;
        case 0xFE:
            return MotorCommand::set_zero;
        default:
            return MotorCommand::control;
        }
    }

    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        return has_id(frame, config_.feedback_id) || command(frame) != MotorCommand::none;
    }

    /// Returns true for a frame on the identifier of the feedback that is not a feedback, such as an answer
    /// about a register, or a command if the motor answers on the identifier of its commands.
    [[nodiscard]] constexpr bool carries_no_values(const Frame& frame) const noexcept {
        const unsigned motor = Protocol::motor_of(frame);
        const bool to_motor = answers_on_own_id() && motor != motor_id();
        return has_id(frame, config_.feedback_id) && Protocol::has_length(frame.length) &&
               (to_motor || !Protocol::is_feedback(frame, motor));
    }

  private:
    static constexpr LinearFeedback feedback_codes{big_endian_code(8, 16), big_endian_code(24, 12),
                                                   big_endian_code(36, 12)};
    static constexpr LinearCode commanded_position = big_endian_code(0, 16);
    static constexpr LinearCode commanded_velocity = big_endian_code(16, 12);
    static constexpr Signal commanded_gains = big_endian_code(28, 24).signal; ///< kp, kd
    static constexpr LinearCode commanded_torque = big_endian_code(52, 12);

    [[nodiscard]] constexpr unsigned motor_id() const noexcept {
        return static_cast<unsigned>(config_.motor_id);
    }

    [[nodiscard]] constexpr bool answers_on_own_id() const noexcept {
        return config_.feedback_id == motor_id();
    }

    [[nodiscard]] constexpr Frame new_frame(std::uint32_t id) const noexcept {
        Frame frame = make_frame(id, 8);
        frame.fd = frame.bit_rate_switch = config_.fd;
        return frame;
    }

    /// Checks the form of a frame. Motors of one type send classic frames or CAN FD, depending on their
    /// settings.
    [[nodiscard]] static constexpr Reason check_message(const Frame& frame) noexcept {
        return frame.remote                         ? Reason::wrong_frame_type
               : Protocol::has_length(frame.length) ? Reason::ok
                                                    : Reason::wrong_length;
    }

    constexpr Decoded decode_report(const Frame& frame) noexcept {
        const std::optional<ReportedMaximum> reported = Protocol::reported(frame);
        if (!reported) {
            return {};
        }
        const std::array<double, 3> expected{config_.position_max, config_.velocity_max, config_.torque_max};
        const auto index = static_cast<std::size_t>(reported->maximum);
        const bool agrees = // false for NaN
            magnitude(reported->value - expected[index]) <= 1e-3 * expected[index];
        contradicted_[index] = !agrees;
        return status(agrees ? Reason::ok : Reason::full_scale_contradicted);
    }

    [[nodiscard]] constexpr LinearScale scale() const noexcept {
        return {config_.joint,      config_.position_max,    config_.velocity_max,
                config_.torque_max, config_.motor_per_joint, config_.zero_rad};
    }

    [[nodiscard]] constexpr Decoded decode_feedback(const Frame& frame) const noexcept {
        Decoded decoded = feedback_codes.decode(frame, scale(), Protocol::condition(frame));
        JointValue& value = decoded.joint[0];
        value.has_velocity = !contradicted_[1];
        if (value.position_reason == Reason::ok && contradicted_[0]) {
            value.position_reason = Reason::full_scale_contradicted;
        }
        if (value.effort_reason == Reason::ok && contradicted_[2]) {
            value.effort_reason = Reason::full_scale_contradicted;
        }
        return decoded;
    }

    Config config_;
    std::array<bool, 3> contradicted_{}; ///< the last report of each maximum differed
};

} // namespace dfdyn::hal
