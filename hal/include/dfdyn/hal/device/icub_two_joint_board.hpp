// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/icub_id.hpp"

#include <numbers>

namespace dfdyn::hal::icub {

/// One joint of an iCub motor board, with the terms of the robot's configuration files.
struct EncoderScale {
    int joint = unused_joint;    ///< joint of the arm, from 0
    double ticks_per_degree = 1; ///< `Encoder`; its sign gives the direction; not 0
    double zero_deg = 0;         ///< `Zeros`: angle = ticks / ticks_per_degree - zero
};

/// An iCub motor board of the MC4/BLL/DSP family, with two joints. Frames by identifier, where A is the
/// address:
/// - 0x101 + 16 A, POSITION, 8 bytes: ticks of joint A and of joint B, int32
/// - 0x103 + 16 A, STATUS, 8 bytes: flags A, mode A, flags B, mode B, CAN status, board status, error
///   counters
/// - 0x105 + 16 A, OVERFLOW, any length: the board lost messages
///
/// Positions carry `encoder_fault` after a STATUS with the joint's bit 0x20 (absolute encoder) or 0x40
/// (optical encoder) until one without. The board reports no efforts. Other faults of the motor do not affect
/// the position.
class TwoJointBoard {
  public:
    static constexpr int joints = 2;

    constexpr TwoJointBoard(int address, const EncoderScale& a, const EncoderScale& b) noexcept
        : address_(address), scale_{a, b} {}

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == id_of(position_type) || id == id_of(status_type) || id == id_of(overflow_type);
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (has_id(frame, id_of(position_type))) {
            return decode_position(frame);
        }
        if (has_id(frame, id_of(status_type))) {
            return decode_status(frame);
        }
        Decoded decoded;
        if (has_id(frame, id_of(overflow_type))) {
            decoded.kind = Decoded::Kind::lost;
            decoded.reason = Reason::frames_lost;
        }
        return decoded;
    }

    [[nodiscard]] FrameList encode(const std::array<JointValue, 2>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        frames.frame[0] = make_frame(id_of(position_type), 8);
        for (std::size_t i = 0; i < 2; ++i) {
            const double degrees = values[i].position_rad * degrees_per_radian + scale_[i].zero_deg;
            store_little(frames.frame[0].data.data() + 4 * i,
                         saturated<std::int32_t>(degrees * scale_[i].ticks_per_degree));
        }
        return frames;
    }

    /// Returns the STATUS frame that the board sends for these flags of its joints.
    [[nodiscard]] constexpr Frame encode_status(std::uint8_t flags_a, std::uint8_t flags_b) const noexcept {
        Frame frame = make_frame(id_of(status_type), 8);
        frame.data[0] = flags_a;
        frame.data[2] = flags_b;
        return frame;
    }

    static constexpr std::uint8_t absolute_encoder_error = 0x20;
    static constexpr std::uint8_t optical_encoder_error = 0x40;

  private:
    static constexpr std::uint32_t position_type = 0x1;
    static constexpr std::uint32_t status_type = 0x3;
    static constexpr std::uint32_t overflow_type = 0x5;
    static constexpr double degrees_per_radian = 180 / std::numbers::pi;

    [[nodiscard]] constexpr std::uint32_t id_of(std::uint32_t type) const noexcept {
        return identifier(periodic_motor_class, address_, type);
    }

    [[nodiscard]] constexpr Decoded decode_position(const Frame& frame) const noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = joints;
        for (std::size_t i = 0; i < 2; ++i) {
            const auto ticks = static_cast<double>(load_little<std::int32_t>(frame.data.data() + 4 * i));
            JointValue& value = decoded.joint[i];
            value.joint = scale_[i].joint;
            value.stamp_ns = frame.stamp_ns;
            value.position_reason = encoder_fault_[i] ? Reason::encoder_fault : Reason::ok;
            value.raw_zero = ticks == 0;
            value.position_rad =
                (ticks / scale_[i].ticks_per_degree - scale_[i].zero_deg) / degrees_per_radian;
            value.step_rad = magnitude(1 / (scale_[i].ticks_per_degree * degrees_per_radian));
            value.wrap_rad = 4294967296.0 * value.step_rad;
            value.from_zero_rad = value.position_rad + scale_[i].zero_deg / degrees_per_radian;
        }
        return decoded;
    }

    constexpr Decoded decode_status(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            encoder_fault_[i] = (frame.data[2 * i] & (absolute_encoder_error | optical_encoder_error)) != 0;
        }
        return status(encoder_fault_[0] || encoder_fault_[1] ? Reason::encoder_fault : Reason::ok);
    }

    int address_;
    std::array<EncoderScale, 2> scale_;
    std::array<bool, 2> encoder_fault_{};
};

static_assert(JointSource<TwoJointBoard>);

} // namespace dfdyn::hal::icub
