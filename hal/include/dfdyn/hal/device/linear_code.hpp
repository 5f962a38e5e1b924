// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"

namespace dfdyn::hal {

/// A number of n bits that a motor sends for a value in ±maximum: value = code / (2^n - 1) · 2 maximum -
/// maximum. Codes saturate.
struct LinearCode {
    Signal signal;

    [[nodiscard]] constexpr double largest() const noexcept {
        return static_cast<double>((std::uint64_t{1} << static_cast<unsigned>(signal.length)) - 1);
    }
    [[nodiscard]] constexpr double value(const Frame& frame, double maximum) const noexcept {
        return signal.extract({frame.data.data(), 8}) / largest() * 2 * maximum - maximum;
    }
    void insert(double value, double maximum, Frame& frame) const noexcept {
        signal.insert({frame.data.data(), 8}, (value + maximum) / (2 * maximum) * largest());
    }
    /// Returns the difference of the values of consecutive codes.
    [[nodiscard]] constexpr double step(double maximum) const noexcept { return 2 * maximum / largest(); }
    [[nodiscard]] constexpr bool is_at_end(const Frame& frame) const noexcept {
        return signal.is_at_end({frame.data.data(), 8});
    }
};

/// Returns a big-endian code whose highest bit is bit 7 - `bit` % 8 of byte `bit` / 8.
constexpr LinearCode big_endian_code(int bit, int bits) noexcept {
    return {{.start_bit = bit / 8 * 8 + 7 - bit % 8, .length = bits, .byte_order = ByteOrder::motorola}};
}

/// Maxima of a motor's codes, and its position in the arm.
struct LinearScale {
    int joint = 0;              ///< joint of the arm, from 0
    double position_max = 0;    ///< rad
    double velocity_max = 0;    ///< rad/s
    double torque_max = 0;      ///< N·m
    double motor_per_joint = 1; ///< ratio of a transmission behind the motor's own gear, with its sign
    double zero_rad = 0;        ///< position of the joint where the motor reports 0
};

/// Codes of position, velocity and torque in a feedback.
struct LinearFeedback {
    LinearCode position, velocity, torque;

    /// Decodes the values of a motor in this condition. Codes at an end carry `position_out_of_range` and
    /// `output_saturated`.
    [[nodiscard]] constexpr Decoded decode(const Frame& frame, const LinearScale& scale,
                                           Reason condition) const noexcept {
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = scale.joint;
        value.stamp_ns = frame.stamp_ns;
        const double motor_rad = position.value(frame, scale.position_max);
        value.from_zero_rad = motor_rad / scale.motor_per_joint;
        value.position_rad = value.from_zero_rad + scale.zero_rad;
        const double step_rad = position.step(scale.position_max);
        value.step_rad = magnitude(step_rad / scale.motor_per_joint);
        value.raw_zero = magnitude(motor_rad) < step_rad; // no code represents exactly 0
        value.has_velocity = true;
        value.velocity = velocity.value(frame, scale.velocity_max) / scale.motor_per_joint;
        value.position_reason = condition != Reason::ok     ? condition
                                : position.is_at_end(frame) ? Reason::position_out_of_range
                                                            : Reason::ok;
        value.effort = torque.value(frame, scale.torque_max) * scale.motor_per_joint;
        value.effort_reason = condition != Reason::ok   ? condition
                              : torque.is_at_end(frame) ? Reason::output_saturated
                                                        : Reason::ok;
        return decoded;
    }

    void encode(const JointValue& value, const LinearScale& scale, Frame& frame) const noexcept {
        const double motor_rad = (value.position_rad - scale.zero_rad) * scale.motor_per_joint;
        position.insert(motor_rad, scale.position_max, frame);
        velocity.insert(value.has_velocity ? value.velocity * scale.motor_per_joint : 0, scale.velocity_max,
                        frame);
        torque.insert(value.effort / scale.motor_per_joint, scale.torque_max, frame);
    }
};

} // namespace dfdyn::hal
