// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/motor_command.hpp"

#include <numbers>
#include <optional>

namespace dfdyn::hal {

/// Version of the driver of an RMD motor. The versions differ in the identifier of the answers and in scales.
enum class RmdDriver : std::uint8_t {
    v2, ///< V2.x: answers on the identifier of the requests
    v3  ///< V3 and V4
};

/// Answer of an RMD motor from which its position is taken.
enum class RmdPosition : std::uint8_t {
    multi_turn, ///< 0x92: 0.01 °
    encoder,    ///< 0x60: counts of the encoder over several turns
    status      ///< 0x9C and control answers: 1 ° (V2: 16384 counts per turn)
};

/// A MyActuator RMD motor. Layout: Motor Motion Protocol V4.2 (2024-05) and three drivers that agree with it.
/// Classic frames of 8 bytes, little-endian; the first byte is the command:
/// - 0x140 + motor: requests and commands. 0xA1: current i16 (0.01 A) at byte 4.
/// - 0x240 + motor: answers.
///   - 0x92: angle i32 (0.01 °) at byte 4. 0x60: encoder i32 (counts) at byte 4.
///   - 0x9C, answers to 0xA1 … 0xA8: temperature i8, current i16 (0.01 A), speed i16 (°/s), angle i16 (°).
///   - 0x9A: errors u16 at byte 6, 0: none.
///
/// A control answer and the 0x9C after it report one current: only the first of the two gives values.
///
/// V2 drivers answer on 0x140 + motor, with a current of 33/2048 A per count. Their 0x9C contains an encoder
/// of 16384 counts per turn instead of the angle. The angle of 0x92 has seven bytes. Requests come on the
/// same identifier: they have zeros after the command.
/// - A command 0xA1 … 0xA9 has 0 where its answer has the temperature; 0xA5 and 0xA6 have 0 or 1, the
///   direction. So an answer at 0 °C, or one to 0xA5 or 0xA6 at 1 °C, is taken for a command, without values.
/// - An angle of exactly 0 looks like its request. It is used, with the stamp of the next answer with a
///   speed, if exactly two such frames, request and answer, come before that answer, and the speed is 0.
///
/// An angle of 1 ° is too coarse for learning; 0x92 or 0x60 is needed. Values carry `device_fault` after an
/// answer 0x9A with errors, until two in a row without errors. A flipped bit can turn 0x92, the answer with
/// the angle, into 0x9A. A negative angle then reads as errors that exclude each other, and is rejected.
class RmdMotor {
  public:
    static constexpr int joints = 1;

    struct Config {
        int motor_id = 1; ///< 1 … 32
        int joint = 0;    ///< joint of the arm, from 0
        RmdDriver driver = RmdDriver::v3;
        RmdPosition position = RmdPosition::multi_turn;
        double counts_per_turn = 65536;     ///< of RmdPosition::encoder
        double newton_metre_per_ampere = 0; ///< of the motor's output; 0: efforts are currents (A)
        double motor_per_joint = 1;         ///< angle of the position per angle of the joint, with its sign
        double zero_rad = 0;                ///< position of the joint where the motor reports 0
    };

    explicit constexpr RmdMotor(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept { return id == answer_id(); }

    [[nodiscard]] constexpr bool concerns(const Frame& frame) const noexcept {
        return has_id(frame, answer_id()) || has_id(frame, request_id());
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (!has_id(frame, answer_id()) || (frame.remote && config_.driver == RmdDriver::v2)) {
            return {};
        }
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        if (config_.driver == RmdDriver::v2 && is_request(frame)) {
            const bool counts = is_zero_position(frame) && zero_frames_ < too_many_zeros;
            zero_frames_ = static_cast<std::uint8_t>(zero_frames_ + (counts ? 1 : 0));
            return {};
        }
        if (is_position(frame.data[0])) {
            zero_frames_ = 0;
            return position(frame, angle(frame));
        }
        if (frame.data[0] == 0x9A) {
            return decode_errors(frame);
        }
        return is_status(frame.data[0]) ? take_status(frame) : Decoded{};
    }

    /// Encodes the replies 0x92 (or 0x60) and 0x9C.
    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        const JointValue& value = values[0];
        const double motor_rad = (value.position_rad - config_.zero_rad) * config_.motor_per_joint;
        if (config_.position != RmdPosition::status) {
            Frame& frame = frames.frame[static_cast<std::size_t>(frames.count++)];
            frame = make_frame(answer_id(), 8);
            encode_position(motor_rad, frame);
        }
        Frame& frame = frames.frame[static_cast<std::size_t>(frames.count++)];
        frame = make_frame(answer_id(), 8);
        frame.data[0] = 0x9C;
        frame.data[1] = 25; // °C
        const double speed = value.has_velocity ? value.velocity * config_.motor_per_joint : 0;
        store_little(frame.data.data() + 2, saturated<std::int16_t>(value.effort / effort_step()));
        store_little(frame.data.data() + 4, saturated<std::int16_t>(speed / degree));
        store_little(frame.data.data() + 6, saturated<std::int16_t>(motor_rad / coarse_step()));
        return frames;
    }

    /// Encodes the current for a joint torque (N·m). Requires `newton_metre_per_ampere`.
    [[nodiscard]] Frame encode_torque(double torque_Nm) const noexcept {
        Frame frame = make_frame(request_id(), 8);
        frame.data[0] = torque_command;
        store_little(frame.data.data() + 4, saturated<std::int16_t>(torque_Nm / effort_step()));
        return frame;
    }

    /// Decodes the joint torque command (N·m) to this motor. Returns nothing for any other frame.
    [[nodiscard]] constexpr std::optional<double> decode_torque(const Frame& frame) const noexcept {
        if (!has_id(frame, request_id()) || check_form(frame, 8) != Reason::ok ||
            frame.data[0] != torque_command || !is_request(frame)) {
            return std::nullopt;
        }
        return load_little<std::int16_t>(frame.data.data() + 4) * effort_step();
    }

    /// Returns the kind of command in `frame`.
    [[nodiscard]] constexpr MotorCommand command(const Frame& frame) const noexcept {
        if (!has_id(frame, request_id()) || frame.remote || frame.fd || frame.length != 8 ||
            (config_.driver == RmdDriver::v2 && !is_request(frame))) {
            return MotorCommand::none;
        }
        switch (frame.data[0]) {
        case 0x80:
        case 0x81:
            return MotorCommand::disable;
        case 0x88:
        case 0x77:
            return MotorCommand::enable;
        case 0x63:
        case 0x64:
        case 0x19:
            return MotorCommand::set_zero;
        case 0x9B:
        case 0x76:
            return MotorCommand::clear_faults;
        case 0x31:
        case 0x32:
        case 0x43:
        case 0x79:
            return MotorCommand::configure;
        default:
            return is_control(frame.data[0]) ? MotorCommand::control
                   : is_poll(frame.data[0])  ? MotorCommand::poll
                                             : MotorCommand::read;
        }
    }

    /// Returns true for a frame on the identifier of the answers that has no values: a request, another
    /// answer, or a 0x9C after a control answer. Call it before `decode`.
    [[nodiscard]] constexpr bool carries_no_values(const Frame& frame) const noexcept {
        if (!has_id(frame, answer_id()) || frame.remote || frame.length != 8) {
            return false;
        }
        const bool zero_answer = is_zero_position(frame) && zero_frames_ == 1 && has_status_;
        return (config_.driver == RmdDriver::v2 && is_request(frame) && !zero_answer) ||
               !(is_status(frame.data[0]) || is_position(frame.data[0])) || repeats_status(frame);
    }

  private:
    struct Angle {
        std::int64_t counts;
        double step_rad;
    };

    static constexpr std::uint8_t torque_command = 0xA1;
    static constexpr std::uint8_t too_many_zeros = 3; ///< a request and its answer are two
    static constexpr double degree = std::numbers::pi / 180;

    [[nodiscard]] constexpr std::uint32_t request_id() const noexcept {
        return 0x140U + static_cast<std::uint32_t>(config_.motor_id);
    }
    [[nodiscard]] constexpr std::uint32_t answer_id() const noexcept {
        return config_.driver == RmdDriver::v2 ? request_id() : request_id() + 0x100U;
    }
    [[nodiscard]] constexpr double current_step() const noexcept {
        return config_.driver == RmdDriver::v2 ? 33.0 / 2048 : 0.01;
    }
    [[nodiscard]] constexpr double effort_step() const noexcept {
        const bool torque = config_.newton_metre_per_ampere != 0;
        return current_step() * (torque ? config_.newton_metre_per_ampere * config_.motor_per_joint
                                        : (config_.motor_per_joint < 0 ? -1 : 1));
    }
    [[nodiscard]] constexpr double coarse_step() const noexcept {
        return config_.driver == RmdDriver::v2 ? 2 * std::numbers::pi / 16384 : degree;
    }

    /// Returns the resolution (rad) of the position, except of RmdPosition::status.
    [[nodiscard]] constexpr double fine_step() const noexcept {
        return config_.position == RmdPosition::encoder ? 2 * std::numbers::pi / config_.counts_per_turn
                                                        : 0.01 * degree;
    }

    /// Returns true for the first byte of a frame with the position, or of a request for it.
    [[nodiscard]] constexpr bool is_position(std::uint8_t command) const noexcept {
        return config_.position != RmdPosition::status &&
               command == (config_.position == RmdPosition::encoder ? 0x60 : 0x92);
    }
    [[nodiscard]] static constexpr bool is_status(std::uint8_t command) noexcept {
        return command == 0x9C || is_control(command);
    }
    [[nodiscard]] static constexpr bool is_control(std::uint8_t command) noexcept {
        return command >= 0xA1 && command <= 0xA9;
    }
    /// Returns true for a request of angles, currents or speeds.
    [[nodiscard]] static constexpr bool is_poll(std::uint8_t command) noexcept {
        return command == 0x60 || (command >= 0x90 && command <= 0x94) || command == 0x9C || command == 0x9D;
    }

    /// Returns true for a request or a command on an identifier that answers have, too.
    [[nodiscard]] static constexpr bool is_request(const Frame& frame) noexcept {
        if (is_control(frame.data[0])) {
            const bool has_direction = frame.data[0] == 0xA5 || frame.data[0] == 0xA6;
            return frame.data[1] <= (has_direction ? 1 : 0);
        }
        return load_little<std::uint64_t>(frame.data.data()) >> 8U == 0; // all bytes after the command
    }

    /// Returns true for a request of a V2 driver's position, and for an answer of exactly 0.
    [[nodiscard]] constexpr bool is_zero_position(const Frame& frame) const noexcept {
        return config_.driver == RmdDriver::v2 && is_position(frame.data[0]) && is_request(frame);
    }

    /// Returns true for a 0x9C that reports the current of the control answer before it again.
    [[nodiscard]] constexpr bool repeats_status(const Frame& frame) const noexcept {
        return frame.data[0] == 0x9C && after_control_;
    }

    /// Returns the angle of an answer 0x92 or 0x60.
    [[nodiscard]] constexpr Angle angle(const Frame& frame) const noexcept {
        if (config_.driver == RmdDriver::v3 || config_.position == RmdPosition::encoder) {
            return {load_little<std::int32_t>(frame.data.data() + 4), fine_step()};
        }
        const auto all = load_little<std::uint64_t>(frame.data.data()); // the command is its lowest byte
        return {std::bit_cast<std::int64_t>(all) >> 8, fine_step()};
    }

    void encode_position(double motor_rad, Frame& frame) const noexcept {
        const auto counts = saturated<std::int32_t>(motor_rad / fine_step());
        const bool encoder = config_.position == RmdPosition::encoder;
        if (config_.driver == RmdDriver::v2 && !encoder) {
            store_little(frame.data.data(), static_cast<std::int64_t>(counts) * 256);
        } else {
            store_little(frame.data.data() + 4, counts);
        }
        frame.data[0] = encoder ? 0x60 : 0x92;
    }

    [[nodiscard]] constexpr Decoded values(const Frame& frame) const noexcept {
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        decoded.joint[0].joint = config_.joint;
        decoded.joint[0].stamp_ns = frame.stamp_ns;
        return decoded;
    }

    constexpr void set_position(const Angle& angle, JointValue& value) const noexcept {
        value.from_zero_rad = static_cast<double>(angle.counts) * angle.step_rad / config_.motor_per_joint;
        value.position_rad = value.from_zero_rad + config_.zero_rad;
        value.step_rad = magnitude(angle.step_rad / config_.motor_per_joint);
        value.raw_zero = angle.counts == 0;
        value.position_reason = faulty_ ? Reason::device_fault : Reason::ok;
    }

    [[nodiscard]] constexpr Decoded position(const Frame& frame, const Angle& angle) const noexcept {
        Decoded decoded = values(frame);
        set_position(angle, decoded.joint[0]);
        return decoded;
    }

    constexpr Decoded take_status(const Frame& frame) noexcept {
        const bool at_zero = zero_frames_ == 2 && load_little<std::int16_t>(frame.data.data() + 4) == 0;
        zero_frames_ = 0;
        const bool repeats = repeats_status(frame);
        after_control_ = frame.data[0] != 0x9C;
        has_status_ = true;
        if (repeats && !at_zero) {
            return {};
        }
        Decoded decoded = repeats ? values(frame) : decode_status(frame);
        if (at_zero) {
            set_position({0, fine_step()}, decoded.joint[0]);
        }
        return decoded;
    }

    [[nodiscard]] constexpr Decoded decode_status(const Frame& frame) const noexcept {
        Decoded decoded = values(frame);
        JointValue& value = decoded.joint[0];
        const auto current = load_little<std::int16_t>(frame.data.data() + 2);
        value.effort = current * effort_step();
        value.effort_reason = faulty_              ? Reason::device_fault
                              : is_at_end(current) ? Reason::output_saturated
                                                   : Reason::ok;
        value.has_velocity = true;
        value.velocity = load_little<std::int16_t>(frame.data.data() + 4) * degree / config_.motor_per_joint;
        if (config_.position == RmdPosition::status) {
            set_coarse_position(frame, value);
        }
        return decoded;
    }

    constexpr void set_coarse_position(const Frame& frame, JointValue& value) const noexcept {
        if (config_.driver == RmdDriver::v2) {
            set_position({load_little<std::uint16_t>(frame.data.data() + 6), coarse_step()}, value);
            value.wrap_rad = magnitude(2 * std::numbers::pi / config_.motor_per_joint);
        } else {
            set_position({load_little<std::int16_t>(frame.data.data() + 6), coarse_step()}, value);
        }
    }

    constexpr Decoded decode_errors(const Frame& frame) noexcept {
        constexpr unsigned both_voltages = 0x0C; // too low, and too high
        const bool old = config_.driver == RmdDriver::v2;
        const unsigned errors = old ? frame.data[7] : load_little<std::uint16_t>(frame.data.data() + 6);
        if (old ? errors == 0xFF : (errors & both_voltages) == both_voltages) {
            return rejected(Reason::wrong_frame_type);
        }
        faulty_ = errors != 0 || (faulty_ && !cleared_once_);
        cleared_once_ = errors == 0;
        return status(faulty_ ? Reason::device_fault : Reason::ok);
    }

    Config config_;
    bool faulty_ = false;
    bool cleared_once_ = false;    ///< the last answer 0x9A has no errors
    bool after_control_ = false;   ///< the last answer with a current was to a control command
    bool has_status_ = false;      ///< an answer with a current has arrived
    std::uint8_t zero_frames_ = 0; ///< frames of `is_zero_position` since the last other angle or speed
};

static_assert(JointSource<RmdMotor>);

} // namespace dfdyn::hal
