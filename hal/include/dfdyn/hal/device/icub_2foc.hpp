// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/icub_id.hpp"

#include <numbers>

namespace dfdyn::hal::icub {

/// An iCub motor board of the 2FOC/AMC family, with one motor. Its effort is the motor current. Frames by
/// identifier, where A is the address; contents are little-endian:
/// - 0x100 + 16 A, 8 bytes: current (mA) int16, velocity int16, position int32 in 1/65536 of a turn
/// - 0x103 + 16 A, STATUS, 8 bytes: mode, encoder errors, PWM (2 bytes), fault word (4 bytes)
///
/// Positions carry `encoder_fault` after a STATUS with encoder errors until one without. Currents carry
/// `device_fault` after a STATUS with a nonzero fault word until one with 0. A current at an end of its 16
/// bits carries `output_saturated`.
class FocBoard {
  public:
    static constexpr int joints = 1;

    struct Config {
        int address = 1;
        int joint = 0; ///< joint of the arm, from 0
        double motor_per_joint =
            1; ///< ratio of the transmission: turns of the encoder per turn of the joint, with its sign
        double zero_rad = 0; ///< position of the joint where the encoder reports 0
    };

    explicit constexpr FocBoard(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == id_of(motion_type) || id == id_of(status_type);
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (has_id(frame, id_of(motion_type))) {
            return decode_motion(frame);
        }
        return has_id(frame, id_of(status_type)) ? decode_status(frame) : Decoded{};
    }

    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        Frame& frame = frames.frame[0];
        frame = make_frame(id_of(motion_type), 8);
        const double motor_rad = (values[0].position_rad - config_.zero_rad) * config_.motor_per_joint;
        store_little(frame.data.data(), saturated<std::int16_t>(1000 * values[0].effort));
        store_little(frame.data.data() + 4, saturated<std::int32_t>(motor_rad / radians_per_count));
        return frames;
    }

    /// Returns the STATUS frame that the board sends for these errors.
    [[nodiscard]] constexpr Frame encode_status(std::uint8_t encoder_errors,
                                                std::uint32_t faults) const noexcept {
        Frame frame = make_frame(id_of(status_type), 8);
        frame.data[1] = encoder_errors;
        store_little(frame.data.data() + 4, faults);
        return frame;
    }

  private:
    static constexpr std::uint32_t motion_type = 0x0;
    static constexpr std::uint32_t status_type = 0x3;
    static constexpr double radians_per_count = 2 * std::numbers::pi / 65536;

    [[nodiscard]] constexpr std::uint32_t id_of(std::uint32_t type) const noexcept {
        return identifier(periodic_motor_class, config_.address, type);
    }

    [[nodiscard]] constexpr Decoded decode_motion(const Frame& frame) const noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const auto counts = static_cast<double>(load_little<std::int32_t>(frame.data.data() + 4));
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        value.stamp_ns = frame.stamp_ns;
        value.position_reason = encoder_fault_ ? Reason::encoder_fault : Reason::ok;
        value.raw_zero = counts == 0;
        value.position_rad = counts * radians_per_count / config_.motor_per_joint + config_.zero_rad;
        value.step_rad = magnitude(radians_per_count / config_.motor_per_joint);
        value.wrap_rad = 4294967296.0 * value.step_rad;
        value.from_zero_rad = value.position_rad - config_.zero_rad;
        const auto milliamperes = load_little<std::int16_t>(frame.data.data());
        value.effort_reason = device_fault_             ? Reason::device_fault
                              : is_at_end(milliamperes) ? Reason::output_saturated
                                                        : Reason::ok;
        value.effort = 1e-3 * milliamperes;
        return decoded;
    }

    constexpr Decoded decode_status(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        encoder_fault_ = frame.data[1] != 0;
        device_fault_ = load_little<std::uint32_t>(frame.data.data() + 4) != 0;
        return status(encoder_fault_  ? Reason::encoder_fault
                      : device_fault_ ? Reason::device_fault
                                      : Reason::ok);
    }

    Config config_;
    bool encoder_fault_ = false;
    bool device_fault_ = false;
};

static_assert(JointSource<FocBoard>);

} // namespace dfdyn::hal::icub
