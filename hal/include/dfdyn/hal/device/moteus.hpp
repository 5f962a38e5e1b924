// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/moteus_subframes.hpp"
#include "dfdyn/hal/device/motor_command.hpp"

#include <limits>
#include <numbers>
#include <optional>

namespace dfdyn::hal {

/// A moteus controller, on CAN FD. Identifier: prefix (bits 28 … 16), source (15 … 8; bit 15: a reply is
/// wanted), destination (7 … 0). One that fits into 11 bits may be sent as a standard one. Frames contain
/// sub-frames (MoteusSubframes). Registers of a reply, and the size of one count as int8, int16, int32
/// (docs/protocol/ registers.md, 17fbf26):
/// - 0 mode: 0 stopped, 1 fault, 5 … 10 operating, 11 timeout, 12 zero velocity, 13 stay within, 15 brake
/// - 1 position: 1e-2, 1e-4, 1e-5 turns of the output; 2 velocity: 0.1, 2.5e-4, 1e-5 turns/s
/// - 3 torque: 0.5, 0.01, 0.001 N·m; 15 fault: 1 … 95 is a fault, 96 and above a limit that is active
///
/// A reply contains the requested registers, in any order and type. If their order or types differ from
/// before, they are trusted from the third such reply on (MoteusLayouts). The most negative integer, or a
/// NaN, means "no value": `position_out_of_range`, `output_out_of_range`. Mode and fault remain valid until
/// the next reply that contains them. Values carry `device_not_operational` while the device does not
/// operate, and `device_fault` in mode 1, with a fault, and in undocumented modes.
class MoteusController {
  public:
    static constexpr int joints = 1;

    struct Config {
        int id = 1;                 ///< 1 … 127
        int host = 0;               ///< 0 … 127: destination of the replies
        int prefix = 0;             ///< of the identifiers (`can.prefix`)
        int joint = 0;              ///< joint of the arm, from 0
        double motor_per_joint = 1; ///< ratio of a transmission behind the output, with its sign
        double zero_rad = 0;        ///< position of the joint where the controller reports 0
    };

    explicit constexpr MoteusController(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept { return id == reply_id(); }

    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        const std::uint32_t source = frame.id >> 8U & 0x7FU;
        const std::uint32_t destination = frame.id & 0x7FU;
        const auto id = static_cast<std::uint32_t>(config_.id);
        return !frame.error && frame.id >> 16U == static_cast<std::uint32_t>(config_.prefix) &&
               (source == id || destination == id);
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (frame.error || frame.id != reply_id()) {
            return {};
        }
        if (frame.remote || !frame.fd) {
            return rejected(Reason::wrong_frame_type);
        }
        Reply reply;
        if (const Reason fault = read(frame, reply); fault != Reason::ok) {
            return rejected(fault);
        }
        const bool has_values = reply.position || reply.torque || reply.velocity;
        const bool about_state = reply.mode || reply.fault;
        if ((has_values || about_state) && !layouts_.take(reply.layout)) {
            return rejected(Reason::wrong_frame_type);
        }
        mode_ = reply.mode.value_or(mode_);
        fault_ = reply.fault.value_or(fault_);
        if (has_values) {
            return values(frame, reply);
        }
        return about_state ? status(condition()) : Decoded{};
    }

    /// Encodes the reply of a controller in mode position: mode int8; position, velocity, torque float; fault
    /// int8.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = 1;
        const JointValue& value = values[0];
        MoteusWriter writer(reply_id());
        writer.bytes({0x21, 0x00, position_mode, 0x2F, 0x01});
        writer.real((value.position_rad - config_.zero_rad) * config_.motor_per_joint / radians_per_turn);
        writer.real(value.has_velocity ? value.velocity * config_.motor_per_joint / radians_per_turn : 0);
        writer.real(value.effort / config_.motor_per_joint);
        writer.bytes({0x21, 0x0F, 0x00});
        frames.frame[0] = writer.frame();
        return frames;
    }

    /// Encodes a joint torque command (N·m): mode position without stiffness and damping. Requests a reply
    /// like `encode`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        MoteusWriter writer(command_id());
        writer.bytes({0x01, 0x00, position_mode, 0x02, 0x20, no_value, no_value, 0x0D, 0x22});
        writer.real(torque_Nm / config_.motor_per_joint);
        writer.bytes({0x02, 0x23, 0, 0, 0x11, 0x00, 0x1F, 0x01, 0x11, 0x0F});
        return writer.frame();
    }

    /// Decodes the joint torque command (N·m) to this controller. Returns nothing for any other frame,
    /// including commands with stiffness or damping.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (!is_command(frame)) {
            return std::nullopt;
        }
        MoteusSubframes subframes(frame);
        double mode = -1;
        double torque = 0;
        double stiffness = 1;
        double damping = 1;
        for (int i = 0; i < most_items; ++i) {
            const MoteusSubframes::Item item = subframes.next();
            if (item.kind == Kind::malformed || item.kind == Kind::unknown) {
                return std::nullopt;
            }
            if (item.kind == Kind::end) {
                break;
            }
            if (item.kind != Kind::write) {
                continue;
            }
            const double plain = item.type == 3 ? static_cast<double>(item.real) : item.integer;
            mode = item.reg == 0x00 ? plain : mode;
            torque = item.reg == 0x22 ? physical(item, torque_steps) : torque;
            stiffness = item.reg == 0x23 ? plain : stiffness;
            damping = item.reg == 0x24 ? plain : damping;
        }
        const bool only_torque = mode == position_mode && stiffness == 0 && damping == 0 && torque == torque;
        return only_torque ? std::optional(torque * config_.motor_per_joint) : std::nullopt;
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (!is_command(frame)) {
            return MotorCommand::none;
        }
        MoteusSubframes subframes(frame);
        MotorCommand found = MotorCommand::poll;
        for (int i = 0; i < most_items; ++i) {
            const MoteusSubframes::Item item = subframes.next();
            if (item.kind != Kind::write && item.kind != Kind::read) {
                break;
            }
            if (item.kind == Kind::write) {
                const bool stops = item.reg == 0 && item.integer == 0 && item.real == 0;
                const bool zeroes = item.reg >= 0x130 && item.reg <= 0x132; // set output nearest, exact
                found = stops    ? MotorCommand::clear_faults
                        : zeroes ? MotorCommand::set_zero
                                 : MotorCommand::control;
                if (stops || zeroes) {
                    break;
                }
            }
        }
        return found;
    }

    /// Returns true for a reply of this controller to a different host than the configured one.
    [[nodiscard]] static constexpr bool is_reply_to_other(const Config& config, const Frame& frame) noexcept {
        return !frame.error && frame.fd && (frame.id & 0x8000U) == 0 &&
               frame.id >> 16U == static_cast<std::uint32_t>(config.prefix) &&
               (frame.id >> 8U & 0x7FU) == static_cast<std::uint32_t>(config.id) &&
               (frame.id & 0x7FU) != static_cast<std::uint32_t>(config.host);
    }

  private:
    using Kind = MoteusSubframes::Kind;
    static constexpr std::uint8_t position_mode = 10;
    static constexpr std::uint8_t no_value = 0x80; ///< int8: the present position, velocity 0
    static constexpr int most_items = 256;
    static constexpr double radians_per_turn = 2 * std::numbers::pi;
    static constexpr std::array<double, 3> position_steps{1e-2, 1e-4, 1e-5};
    static constexpr std::array<double, 3> velocity_steps{0.1, 2.5e-4, 1e-5};
    static constexpr std::array<double, 3> torque_steps{0.5, 0.01, 0.001};

    /// A value of a reply. `step`: of one count; 0 for a float.
    struct Number {
        double value = 0;
        double step = 0;
        bool at_end = false;
    };
    struct Reply {
        std::optional<int> mode, fault;
        std::optional<Number> position, velocity, torque;
        std::uint32_t layout = 1; ///< of the registers that are read, and their types
    };

    [[nodiscard]] constexpr std::uint32_t prefix_bits() const noexcept {
        return static_cast<std::uint32_t>(config_.prefix) << 16U;
    }
    [[nodiscard]] constexpr std::uint32_t reply_id() const noexcept {
        return prefix_bits() | static_cast<std::uint32_t>(config_.id) << 8U |
               static_cast<std::uint32_t>(config_.host);
    }
    [[nodiscard]] constexpr std::uint32_t command_id() const noexcept {
        return prefix_bits() | 0x8000U | static_cast<std::uint32_t>(config_.host) << 8U |
               static_cast<std::uint32_t>(config_.id);
    }
    /// A host may have the number of this controller: a reply to it is no command.
    [[nodiscard]] constexpr bool is_command(const Frame& frame) const noexcept {
        return !frame.error && !frame.remote && frame.fd && frame.id >> 16U == prefix_bits() >> 16U &&
               (frame.id & 0x7FU) == static_cast<std::uint32_t>(config_.id) && !is_reply(frame);
    }

    /// Returns true if the first sub-frame is one that only controllers send: values, an error, or the data
    /// of a channel.
    [[nodiscard]] static constexpr bool is_reply(const Frame& frame) noexcept {
        for (std::size_t i = 0; i < frame.length; ++i) {
            const unsigned code = frame.data[i];
            if (code != 0x50) {
                return (code >= 0x20 && code <= 0x31) || code == 0x41;
            }
        }
        return false;
    }

    [[nodiscard]] static constexpr double physical(const MoteusSubframes::Item& item,
                                                   const std::array<double, 3>& steps) noexcept {
        return item.type == 3 ? static_cast<double>(item.real)
                              : item.integer * steps[static_cast<std::size_t>(item.type)];
    }

    [[nodiscard]] static constexpr Number number(const MoteusSubframes::Item& item,
                                                 const std::array<double, 3>& steps) noexcept {
        if (item.type == 3) {
            const auto value = static_cast<double>(item.real);
            return {value, 0, !(magnitude(value) <= static_cast<double>(std::numeric_limits<float>::max()))};
        }
        const auto bits = static_cast<unsigned>(8 << item.type);
        const std::int64_t largest = (std::int64_t{1} << (bits - 1)) - 1;
        return {physical(item, steps), steps[static_cast<std::size_t>(item.type)],
                item.integer >= largest || item.integer <= -largest};
    }

    [[nodiscard]] static constexpr Reason read(const Frame& frame, Reply& reply) noexcept {
        MoteusSubframes subframes(frame);
        for (int i = 0; i < most_items; ++i) {
            const MoteusSubframes::Item item = subframes.next();
            switch (item.kind) {
            case Kind::end:
                return Reason::ok;
            case Kind::reply:
                take(item, reply);
                break;
            case Kind::malformed:
                return Reason::wrong_length;
            case Kind::write:
            case Kind::read:
            case Kind::unknown:
                return Reason::wrong_frame_type;
            }
        }
        return Reason::wrong_length;
    }

    static constexpr void take(const MoteusSubframes::Item& item, Reply& reply) noexcept {
        if (item.reg <= 0x3 || item.reg == 0xF) {
            constexpr std::uint32_t factor = 16'777'619; // FNV
            reply.layout = (reply.layout ^ (item.reg << 2U | static_cast<std::uint32_t>(item.type))) * factor;
        }
        const double plain = item.type == 3 ? static_cast<double>(item.real) : item.integer;
        const int code = plain >= 0 && plain < 256 ? static_cast<int>(plain) : 255; // 255 for NaN
        switch (item.reg) {
        case 0x0:
            reply.mode = code;
            break;
        case 0x1:
            reply.position = number(item, position_steps);
            break;
        case 0x2:
            reply.velocity = number(item, velocity_steps);
            break;
        case 0x3:
            reply.torque = number(item, torque_steps);
            break;
        case 0xF:
            reply.fault = code;
            break;
        default:
            break;
        }
    }

    [[nodiscard]] constexpr Reason condition() const noexcept {
        const bool fault = fault_ > 0 && fault_ < 96;
        const bool operates = (mode_ >= 5 && mode_ <= 10) || mode_ == 12 || mode_ == 13;
        const bool known = mode_ <= 15 && mode_ != 1;
        return fault || !known ? Reason::device_fault
               : operates      ? Reason::ok
                               : Reason::device_not_operational;
    }

    [[nodiscard]] constexpr Decoded values(const Frame& frame, const Reply& reply) const noexcept {
        const Reason condition = this->condition();
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        value.stamp_ns = frame.stamp_ns;
        if (reply.position) {
            const double turns = reply.position->at_end ? 0 : reply.position->value;
            value.from_zero_rad = turns * radians_per_turn / config_.motor_per_joint;
            value.position_rad = value.from_zero_rad + config_.zero_rad;
            constexpr double float_step = 1.2e-7; // resolution of a float near 1
            const double step =
                reply.position->step > 0 ? reply.position->step : float_step * (1 + magnitude(turns));
            value.step_rad = magnitude(step * radians_per_turn / config_.motor_per_joint);
            value.raw_zero = turns == 0;
            value.position_reason = condition != Reason::ok  ? condition
                                    : reply.position->at_end ? Reason::position_out_of_range
                                                             : Reason::ok;
        }
        if (reply.velocity && !reply.velocity->at_end) {
            value.has_velocity = true;
            value.velocity = reply.velocity->value * radians_per_turn / config_.motor_per_joint;
        }
        if (reply.torque) {
            value.effort = reply.torque->at_end ? 0 : reply.torque->value * config_.motor_per_joint;
            value.effort_reason = condition != Reason::ok ? condition
                                  : reply.torque->at_end  ? Reason::output_out_of_range
                                                          : Reason::ok;
        }
        return decoded;
    }

    Config config_;
    int mode_ = position_mode; ///< as last reported; a device that is never asked is taken to operate
    int fault_ = 0;
    MoteusLayouts layouts_;
};

static_assert(JointSource<MoteusController>);

} // namespace dfdyn::hal
