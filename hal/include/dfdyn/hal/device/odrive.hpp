// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/heartbeat.hpp"

#include <numbers>

namespace dfdyn::hal {

/// An ODrive axis that speaks CANSimple.
///
/// | id (N: node) | length | content, little-endian |
/// | --- | --- | --- |
/// | 32 N + 0x09 | 8 | encoder estimates: position (turns), velocity (turns/s), float |
/// | 32 N + 0x01 | 8 | heartbeat: axis error u32, state, motor error, encoder error, controller status |
///
/// An estimate that the axis does not have is sent as 0.0, so positions are good only while the heartbeat
/// says that the encoder is.
class OdriveAxis {
  public:
    static constexpr int joints = 1;

    struct Config {
        int node = 0;                                    ///< 0 … 63
        int joint = 0;                                   ///< of the arm, from 0
        double motor_per_joint = 1;                      ///< transmission, with its sign
        double zero_rad = 0;                             ///< of the joint where the estimate is 0
        std::int64_t heartbeat_timeout_ns = 250'000'000; ///< it comes every 100 ms by default
    };

    explicit constexpr OdriveAxis(const Config& config) noexcept
        : config_(config), heartbeat_(config.heartbeat_timeout_ns) {}

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == id_of(estimates_command) || id == id_of(heartbeat_command);
    }

    Decoded decode(const Frame& frame) noexcept {
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

    [[nodiscard]] constexpr Frame encode_heartbeat(bool encoder_error) const noexcept {
        Frame frame = make_frame(id_of(heartbeat_command), 8);
        frame.data[encoder_error_byte] = encoder_error ? 1 : 0;
        return frame;
    }

  private:
    static constexpr std::uint32_t heartbeat_command = 0x01;
    static constexpr std::uint32_t estimates_command = 0x09;
    static constexpr std::size_t encoder_error_byte = 6;
    static constexpr double radians_per_turn = 2 * std::numbers::pi;

    [[nodiscard]] constexpr std::uint32_t id_of(std::uint32_t command) const noexcept {
        return static_cast<std::uint32_t>(config_.node) << 5 | command;
    }

    [[nodiscard]] Decoded decode_estimates(const Frame& frame) const noexcept {
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
        value.position_reason =
            std::isfinite(turns) ? heartbeat_.reason(frame.stamp_ns) : Reason::position_out_of_range;
        value.raw_zero = turns == 0;
        value.position_rad = turns * radians_per_turn / config_.motor_per_joint + config_.zero_rad;
        return decoded;
    }

    constexpr Decoded decode_heartbeat(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const Reason condition = frame.data[encoder_error_byte] != 0 ? Reason::encoder_fault : Reason::ok;
        heartbeat_.heard(frame.stamp_ns, condition);
        return status(condition);
    }

    Config config_;
    Heartbeat heartbeat_;
};

static_assert(JointSource<OdriveAxis>);

} // namespace dfdyn::hal
