// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"

#include <optional>

namespace dfdyn::hal {

/// A Damiao DM motor with its own protocol ("MIT mode"), on classic CAN or CAN FD.
///
/// Frames by identifier:
/// - `feedback_id` (register MST_ID), feedback: state and motor id (nibbles), position u16, velocity u12,
///   torque u12, big-endian; two temperatures. Or a register reply: motor id u16, 0x33 (read), 0x55 (written)
///   or 0xAA (saved), register number, value (float), little-endian.
/// - `motor_id`, to the motor: position u16, velocity, kp, kd, torque u12, big-endian.
/// - 0x7FF, to all motors: register access, or 0xCC, which requests a feedback.
///
/// value = code / (2^n - 1) · 2 MAX - MAX, where the MAX values are the motor's registers 21, 22 and 23. They
/// are not in the frames, and libraries disagree about the defaults. If a motor reports a value that differs
/// from `Config`, the values that depend on it carry `full_scale_contradicted` until it reports the same.
///
/// Values carry `device_not_operational` while the motor is disabled, and `device_fault` in any other state
/// except enabled. Codes saturate: a position at an end of its code carries `position_out_of_range`, a torque
/// `output_saturated`. The first byte of a register reply is the motor id alone, like that of the feedback of
/// a disabled motor; the next two bytes distinguish them.
class DamiaoMotor {
  public:
    static constexpr int joints = 1;

    struct Config {
        int motor_id = 1; ///< 1 … 15, register ESC_ID
        std::uint32_t feedback_id = 0x11;
        int joint = 0;              ///< joint of the arm, from 0
        double position_max = 0;    ///< rad, register 21
        double velocity_max = 0;    ///< rad/s, register 22
        double torque_max = 0;      ///< N·m, register 23
        double motor_per_joint = 1; ///< ratio of a transmission behind the motor's own gear, with its sign
        double zero_rad = 0;        ///< position of the joint where the motor reports 0
    };

    /// Requires positive maxima.
    explicit constexpr DamiaoMotor(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept { return id == config_.feedback_id; }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (!has_id(frame, config_.feedback_id)) {
            return {};
        }
        if (const Reason fault = check_message(frame); fault != Reason::ok) {
            return rejected(fault);
        }
        if ((frame.data[0] & 0xFU) != motor_id()) {
            return rejected(Reason::id_collision); // another motor with the same MST_ID
        }
        return is_about_register(frame) ? decode_register(frame) : decode_feedback(frame);
    }

    /// Returns the joint velocity (rad/s) of a feedback frame.
    [[nodiscard]] constexpr double velocity(const Frame& feedback) const noexcept {
        return value_of(velocity_code, feedback, config_.velocity_max) / config_.motor_per_joint;
    }

    /// Encodes the feedback of an enabled motor at rest.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        Frame& frame = frames.frame[0];
        frame = make_frame(config_.feedback_id, 8);
        frame.data[0] = static_cast<std::uint8_t>(enabled << 4 | motor_id());
        const double motor_rad = (values[0].position_rad - config_.zero_rad) * config_.motor_per_joint;
        insert(position_code, motor_rad, config_.position_max, frame);
        insert(velocity_code, 0, config_.velocity_max, frame);
        insert(torque_code, values[0].effort / config_.motor_per_joint, config_.torque_max, frame);
        return frames;
    }

    /// Encodes a joint torque command (N·m) without stiffness and damping, saturated to `torque_max`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        Frame frame = make_frame(motor_id(), 8);
        insert(commanded_position, 0, config_.position_max, frame);
        insert(commanded_velocity, 0, config_.velocity_max, frame);
        insert(commanded_torque, torque_Nm / config_.motor_per_joint, config_.torque_max, frame);
        return frame;
    }

    /// Decodes the joint torque command (N·m) to this motor. Returns nothing for any other frame, including
    /// commands with stiffness or damping and those to enable or disable the motor.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (!has_id(frame, motor_id()) || check_message(frame) != Reason::ok ||
            commanded_gains.extract_raw(data_of(frame)) != 0) {
            return std::nullopt;
        }
        return value_of(commanded_torque, frame, config_.torque_max) * config_.motor_per_joint;
    }

  private:
    static constexpr unsigned enabled = 1;
    static constexpr unsigned disabled = 0;
    /// register of `position_max`; those of the other two maxima follow
    static constexpr int first_maximum = 21;

    static constexpr Signal position_code{.start_bit = 15, .length = 16, .byte_order = ByteOrder::motorola};
    static constexpr Signal velocity_code{.start_bit = 31, .length = 12, .byte_order = ByteOrder::motorola};
    static constexpr Signal torque_code{.start_bit = 35, .length = 12, .byte_order = ByteOrder::motorola};
    static constexpr Signal commanded_position{
        .start_bit = 7, .length = 16, .byte_order = ByteOrder::motorola};
    static constexpr Signal commanded_velocity{
        .start_bit = 23, .length = 12, .byte_order = ByteOrder::motorola};
    static constexpr Signal commanded_gains{
        .start_bit = 27, .length = 24, .byte_order = ByteOrder::motorola}; ///< kp, kd
    static constexpr Signal commanded_torque{
        .start_bit = 51, .length = 12, .byte_order = ByteOrder::motorola};

    [[nodiscard]] constexpr unsigned motor_id() const noexcept {
        return static_cast<unsigned>(config_.motor_id);
    }
    [[nodiscard]] static constexpr std::span<const std::uint8_t> data_of(const Frame& frame) noexcept {
        return {frame.data.data(), 8};
    }
    [[nodiscard]] static constexpr double largest(const Signal& code) noexcept {
        return static_cast<double>((1U << static_cast<unsigned>(code.length)) - 1);
    }
    [[nodiscard]] static constexpr double value_of(const Signal& code, const Frame& frame,
                                                   double maximum) noexcept {
        return code.extract(data_of(frame)) / largest(code) * 2 * maximum - maximum;
    }
    static void insert(const Signal& code, double value, double maximum, Frame& frame) noexcept {
        code.insert({frame.data.data(), 8}, (value + maximum) / (2 * maximum) * largest(code));
    }

    /// Checks the form of a frame. Motors of one type send classic frames or CAN FD, depending on their
    /// settings.
    [[nodiscard]] static constexpr Reason check_message(const Frame& frame) noexcept {
        return frame.remote        ? Reason::wrong_frame_type
               : frame.length == 8 ? Reason::ok
                                   : Reason::wrong_length;
    }

    /// Returns true for a register reply to any program, and for a request that comes back on this
    /// identifier.
    [[nodiscard]] constexpr bool is_about_register(const Frame& frame) const noexcept {
        const std::uint8_t what = frame.data[2];
        return frame.data[0] == motor_id() && frame.data[1] == 0 &&
               (what == 0x33 || what == 0x55 || what == 0xAA || what == 0xCC);
    }

    constexpr Decoded decode_register(const Frame& frame) noexcept {
        const int index = frame.data[3] - first_maximum;
        if ((frame.data[2] != 0x33 && frame.data[2] != 0x55) || index < 0 || index > 2) {
            return {};
        }
        const auto reported = static_cast<double>(load_little<float>(frame.data.data() + 4));
        const std::array<double, 3> expected{config_.position_max, config_.velocity_max, config_.torque_max};
        const double described = expected[static_cast<std::size_t>(index)];
        const bool agrees = magnitude(reported - described) <= 1e-3 * described; // false for NaN
        contradicted_[static_cast<std::size_t>(index)] = !agrees;
        return status(agrees ? Reason::ok : Reason::full_scale_contradicted);
    }

    [[nodiscard]] constexpr Decoded decode_feedback(const Frame& frame) const noexcept {
        const unsigned state = frame.data[0] >> 4U;
        const Reason condition = state == enabled    ? Reason::ok
                                 : state == disabled ? Reason::device_not_operational
                                                     : Reason::device_fault;
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        value.stamp_ns = frame.stamp_ns;
        const double motor_rad = value_of(position_code, frame, config_.position_max);
        value.from_zero_rad = motor_rad / config_.motor_per_joint;
        value.position_rad = value.from_zero_rad + config_.zero_rad;
        const double step_rad = 2 * config_.position_max / largest(position_code);
        value.step_rad = magnitude(step_rad / config_.motor_per_joint);
        value.raw_zero = magnitude(motor_rad) < step_rad; // no code represents exactly 0
        value.position_reason = condition != Reason::ok                   ? condition
                                : contradicted_[0]                        ? Reason::full_scale_contradicted
                                : position_code.is_at_end(data_of(frame)) ? Reason::position_out_of_range
                                                                          : Reason::ok;
        value.effort = value_of(torque_code, frame, config_.torque_max) * config_.motor_per_joint;
        value.effort_reason = condition != Reason::ok                 ? condition
                              : contradicted_[2]                      ? Reason::full_scale_contradicted
                              : torque_code.is_at_end(data_of(frame)) ? Reason::output_saturated
                                                                      : Reason::ok;
        return decoded;
    }

    Config config_;
    std::array<bool, 3> contradicted_{}; ///< the last report of each maximum differed
};

static_assert(JointSource<DamiaoMotor>);

} // namespace dfdyn::hal
