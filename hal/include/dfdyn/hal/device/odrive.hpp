// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/heartbeat.hpp"

#include <numbers>

namespace dfdyn::hal {

/// Firmware version of an ODrive. The versions differ in the meaning of byte 6 of the heartbeat and of the
/// bits of the error word.
enum class OdriveFirmware : std::uint8_t {
    any,  ///< uses the common part: in both versions no encoder has an error while the error word is 0
    v0_5, ///< 0.5.1 to 0.5.6
    v0_6  ///< 0.6 and later: ODrive Pro, S1, Micro
};

/// An ODrive axis with the CANSimple protocol. Frames by identifier, where N is the node; contents are
/// little-endian:
/// - 32 N + 0x09, 8 bytes: encoder estimates: position (turns), velocity (turns/s), float
/// - 32 N + 0x01, 8 bytes, heartbeat of 0.5: axis error u32, state, flags: motor, encoder, controller
/// - 32 N + 0x01, 8 bytes, heartbeat of 0.6: axis error u32, state, result of the procedure, trajectory done
///
/// The axis sends 0.0 for an estimate that it does not have. Positions are therefore valid only while the
/// error word of the heartbeat is 0. A 0.0 after a nonzero estimate carries `encoder_fault`, because the
/// heartbeat arrives later. A fault ends with the first heartbeat without it (`clear_errors`). Remote frames
/// are the host's requests and are ignored.
class OdriveAxis {
  public:
    static constexpr int joints = 1;

    struct Config {
        int node = 0;                                    ///< 0 … 63
        int joint = 0;                                   ///< joint of the arm, from 0
        double motor_per_joint = 1;                      ///< ratio of the transmission, with its sign
        double zero_rad = 0;                             ///< position of the joint where the estimate is 0
        std::int64_t heartbeat_timeout_ns = 250'000'000; ///< the default heartbeat period is 100 ms
        OdriveFirmware firmware = OdriveFirmware::any;
    };

    explicit constexpr OdriveAxis(const Config& config) noexcept
        : config_(config), heartbeat_(config.heartbeat_timeout_ns) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == id_of(estimates_command) || id == id_of(heartbeat_command);
    }

    Decoded decode(const Frame& frame) noexcept {
        if (frame.remote) {
            return {};
        }
        if (has_id(frame, id_of(estimates_command))) {
            return decode_estimates(frame);
        }
        return has_id(frame, id_of(heartbeat_command)) ? decode_heartbeat(frame) : Decoded{};
    }

    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        frames.frame[0] = make_frame(id_of(estimates_command), 8);
        const double motor_rad = (values[0].position_rad - config_.zero_rad) * config_.motor_per_joint;
        store_little(frames.frame[0].data.data(), static_cast<float>(motor_rad / radians_per_turn));
        return frames;
    }

    /// Encodes a heartbeat of firmware 0.5.
    [[nodiscard]] constexpr Frame encode_heartbeat(bool encoder_error) const noexcept {
        Frame frame = make_frame(id_of(heartbeat_command), 8);
        store_little(frame.data.data(), encoder_error ? encoder_failed : 0U);
        frame.data[encoder_error_byte] = encoder_error ? 1 : 0;
        return frame;
    }

  private:
    static constexpr std::uint32_t heartbeat_command = 0x01;
    static constexpr std::uint32_t estimates_command = 0x09;
    static constexpr std::size_t encoder_error_byte = 6;       ///< firmware 0.5
    static constexpr std::uint32_t encoder_failed = 0x100;     ///< bit of the error word of firmware 0.5
    static constexpr std::uint32_t unknown_position = 0x80000; ///< bit of the error word of firmware 0.5
    /// bit of the error word of firmware 0.6; unused in 0.5
    static constexpr std::uint32_t missing_estimate = 0x8;
    static constexpr double radians_per_turn = 2 * std::numbers::pi;

    [[nodiscard]] constexpr std::uint32_t id_of(std::uint32_t command) const noexcept {
        return static_cast<std::uint32_t>(config_.node) << 5 | command;
    }

    Decoded decode_estimates(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const auto turns = static_cast<double>(load_little<float>(frame.data.data()));
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        value.stamp_ns = frame.stamp_ns;
        value.raw_zero = turns == 0;
        const bool lost = value.raw_zero && moved_;
        moved_ = !value.raw_zero;
        value.position_reason = !std::isfinite(turns) ? Reason::position_out_of_range
                                : lost                ? Reason::encoder_fault
                                                      : heartbeat_.reason(frame.stamp_ns);
        value.position_rad = turns * radians_per_turn / config_.motor_per_joint + config_.zero_rad;
        value.from_zero_rad = value.position_rad - config_.zero_rad;
        constexpr double float_step = 1.2e-7; // resolution of a float near 1
        value.step_rad =
            float_step * magnitude(radians_per_turn / config_.motor_per_joint) * (1 + magnitude(turns));
        return decoded;
    }

    constexpr Decoded decode_heartbeat(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const Reason condition = condition_of(frame);
        heartbeat_.heard(frame.stamp_ns, condition);
        return status(condition);
    }

    [[nodiscard]] constexpr Reason condition_of(const Frame& heartbeat) const noexcept {
        const auto error = load_little<std::uint32_t>(heartbeat.data.data());
        const bool flag = heartbeat.data[encoder_error_byte] != 0;
        bool encoder = false;
        switch (config_.firmware) {
        case OdriveFirmware::any:
            encoder = (error & missing_estimate) != 0 || (flag && (error & encoder_failed) != 0);
            break;
        case OdriveFirmware::v0_5:
            encoder = flag || (error & (encoder_failed | unknown_position)) != 0;
            break;
        case OdriveFirmware::v0_6:
            encoder = (error & missing_estimate) != 0;
            break;
        }
        return encoder ? Reason::encoder_fault : error != 0 ? Reason::device_fault : Reason::ok;
    }

    Config config_;
    Heartbeat heartbeat_;
    bool moved_ = false; ///< the last estimate was not 0
};

static_assert(JointSource<OdriveAxis>);

} // namespace dfdyn::hal
