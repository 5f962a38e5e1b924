// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/clock/sync_step.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/heartbeat.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace dfdyn::hal {

/// A CANopen drive with the CiA 402 profile and configurable TPDO mapping. Frames by identifier, where N is
/// the node; contents are little-endian:
/// - 0x080, 0 or 1 byte: SYNC
/// - 0x080 + N, 8 bytes: EMCY: error code u16 (0: no error any more), error register, 5 bytes of the
///   manufacturer
/// - `position_pdo` + N, length as mapped: position actual value (0x6064) and other mapped objects
/// - `effort_pdo` + N, length as mapped: torque actual value (0x6077); may be the same PDO
/// - 0x200 + N, 2 bytes, to the drive: target torque (0x6071), in the unit of 0x6077
/// - 0x700 + N, 1 byte: heartbeat: 0 boot-up, 4 stopped, 5 operational, 127 pre-operational
///
/// The scaling differs between axes and is part of the configured signals.
///
/// Values carry `device_not_operational` from a heartbeat with another state until one with the operational
/// state. Many drives send no heartbeat, but every drive sends a boot-up message. Without
/// `heartbeat_timeout_ns` the next PDO therefore ends a boot-up, because a drive sends PDOs only while it is
/// operational (CiA 301). A heartbeat with another state still rejects every PDO until 3 s without a
/// heartbeat. The first value after a boot-up that interrupts the PDOs carries `device_restarted`.
///
/// Until EMCY 0 or a boot-up, positions carry `encoder_fault` after an EMCY of a sensor (0x73xx), and efforts
/// carry `device_fault` after any EMCY. An effort at an end of its range carries `output_saturated`. A remote
/// frame on the heartbeat's identifier is a master's request (node guarding) and is ignored.
class Cia402Drive {
  public:
    static constexpr int joints = 1;

    struct Config {
        int node = 1;  ///< 1 … 127
        int joint = 0; ///< joint of the arm, from 0
        std::uint32_t position_pdo = 0x280;
        int position_length = 8; ///< bytes of the whole PDO
        Signal position{
            .start_bit = 0, .length = 32, .encoding = Encoding::signed_integer, .factor = 1e-3}; ///< rad
        std::uint32_t effort_pdo = 0; ///< 0: efforts are not mapped; may be `position_pdo`
        int effort_length = 8;
        Signal effort{
            .start_bit = 0, .length = 16, .encoding = Encoding::signed_integer, .factor = 1e-3}; ///< N·m
        bool synchronous = true; ///< measured at the preceding SYNC; otherwise when the PDO arrived
        std::int64_t heartbeat_timeout_ns = 0; ///< 0: the drive sends none (the CANopen default)
    };

    explicit constexpr Cia402Drive(const Config& config) noexcept
        : config_(config), heartbeat_(config.heartbeat_timeout_ns) {}

    /// Returns the description.
    [[nodiscard]] constexpr const Config& config() const noexcept { return config_; }

    /// Returns true if identifiers, lengths and signals are valid; no PDO may use an identifier that CANopen
    /// restricts.
    [[nodiscard]] constexpr bool config_is_valid() const noexcept {
        const bool effort =
            !has_effort() ||
            (config_.effort.fits(config_.effort_length) && config_.effort_length <= 8 &&
             config_.effort.factor != 0 && !restricted(effort_id()) &&
             (effort_id() != position_id() || config_.effort_length == config_.position_length));
        return config_.node >= 1 && config_.node <= 127 && config_.position_length <= 8 &&
               config_.position.fits(config_.position_length) && config_.position.factor != 0 &&
               !restricted(position_id()) && effort;
    }

    /// Returns true if efforts are mapped.
    [[nodiscard]] constexpr bool has_effort() const noexcept { return config_.effort_pdo != 0; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == position_id() || (has_effort() && id == effort_id()) || id == emcy_id() ||
               id == heartbeat_id();
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (has_id(frame, position_id()) || (has_effort() && has_id(frame, effort_id()))) {
            return decode_pdo(frame);
        }
        if (has_id(frame, sync_id)) {
            return decode_sync(frame);
        }
        if (has_id(frame, heartbeat_id())) {
            return decode_heartbeat(frame);
        }
        return has_id(frame, emcy_id()) ? decode_emcy(frame) : Decoded{};
    }

    [[nodiscard]] FrameList encode(const std::array<JointValue, 1>& values) const noexcept {
        FrameList frames;
        frames.count = has_effort() && effort_id() != position_id() ? 2 : 1;
        frames.frame[0] = make_frame(position_id(), config_.position_length);
        config_.position.insert(data_of(frames.frame[0]), values[0].position_rad);
        if (has_effort()) {
            Frame& frame = frames.frame[static_cast<std::size_t>(frames.count - 1)];
            if (frames.count == 2) {
                frame = make_frame(effort_id(), config_.effort_length);
            }
            config_.effort.insert(data_of(frame), values[0].effort);
        }
        return frames;
    }

    enum class State : std::uint8_t { boot_up = 0, stopped = 4, operational = 5, pre_operational = 127 };

    [[nodiscard]] constexpr Frame encode_heartbeat(State state) const noexcept {
        Frame frame = make_frame(heartbeat_id(), 1);
        frame.data[0] = static_cast<std::uint8_t>(state);
        return frame;
    }

    [[nodiscard]] constexpr Frame encode_emcy(std::uint16_t error_code) const noexcept {
        Frame frame = make_frame(emcy_id(), 8);
        store_little(frame.data.data(), error_code);
        return frame;
    }

    /// Encodes a torque command (N·m), saturated to 16 bits. The unit is that of the mapped efforts, which
    /// are required.
    [[nodiscard]] Frame encode_target_torque(double torque_Nm) const noexcept {
        Frame frame = make_frame(target_torque_pdo + static_cast<std::uint32_t>(config_.node), 2);
        target_torque().insert({frame.data.data(), 2}, torque_Nm);
        return frame;
    }

    /// Decodes the torque command (N·m) to this drive. Returns nothing for any other frame.
    [[nodiscard]] std::optional<double> decode_target_torque(const Frame& frame) const noexcept {
        const std::uint32_t id = target_torque_pdo + static_cast<std::uint32_t>(config_.node);
        if (!has_id(frame, id) || frame.remote || frame.fd || frame.length != 2) {
            return std::nullopt;
        }
        return target_torque().extract({frame.data.data(), 2});
    }

    [[nodiscard]] static constexpr Frame encode_sync() noexcept { return make_frame(sync_id, 0); }

  private:
    static constexpr std::uint32_t sync_id = 0x080;
    static constexpr std::uint32_t target_torque_pdo = 0x200;

    [[nodiscard]] constexpr Signal target_torque() const noexcept {
        return {.start_bit = 0,
                .length = 16,
                .encoding = Encoding::signed_integer,
                .factor = config_.effort.factor};
    }

    [[nodiscard]] static constexpr bool restricted(std::uint32_t id) noexcept {
        const auto within = [id](std::uint32_t first, std::uint32_t last) {
            return id >= first && id <= last;
        };
        return id <= 0x80 || within(0x101, 0x180) || within(0x581, 0x5FF) || within(0x601, 0x67F) ||
               within(0x6E0, 0x6FF) || id >= 0x701;
    }

    [[nodiscard]] static constexpr std::span<std::uint8_t> data_of(Frame& frame) noexcept {
        return {frame.data.data(), frame.length};
    }

    [[nodiscard]] constexpr std::uint32_t node() const noexcept {
        return static_cast<std::uint32_t>(config_.node);
    }
    [[nodiscard]] constexpr std::uint32_t position_id() const noexcept {
        return config_.position_pdo + node();
    }
    [[nodiscard]] constexpr std::uint32_t effort_id() const noexcept { return config_.effort_pdo + node(); }
    [[nodiscard]] constexpr std::uint32_t emcy_id() const noexcept { return 0x080 + node(); }
    [[nodiscard]] constexpr std::uint32_t heartbeat_id() const noexcept { return 0x700 + node(); }

    constexpr Decoded decode_pdo(const Frame& frame) noexcept {
        const bool positions = frame.id == position_id();
        if (const Reason fault =
                check_form(frame, positions ? config_.position_length : config_.effort_length);
            fault != Reason::ok) {
            return rejected(fault);
        }
        Decoded decoded;
        decoded.kind = Decoded::Kind::values;
        decoded.joints = 1;
        JointValue& value = decoded.joint[0];
        value.joint = config_.joint;
        const bool to_sync = config_.synchronous && synchronised_;
        value.stamp_ns = to_sync ? sync_ns_ : frame.stamp_ns;
        SyncStep& step = positions ? position_step_ : effort_step_;
        const bool repeats = (positions ? position_content_ : effort_content_).take(frame);
        const bool in_step = !to_sync || step.answer(frame.stamp_ns, repeats);
        const Reason condition = heartbeat_.reason(frame.stamp_ns);
        const std::span<const std::uint8_t> data(frame.data.data(), frame.length);
        sending_ = true;
        if (positions) {
            read_position(data, condition, value);
        }
        if (has_effort() && frame.id == effort_id()) {
            read_effort(data, condition, value);
        }
        if (!in_step) {
            value.position_reason = refused(value.position_reason);
            value.effort_reason = refused(value.effort_reason);
            value.stamp_ns = step.late() ? frame.stamp_ns : value.stamp_ns;
        }
        return decoded;
    }

    constexpr void read_position(std::span<const std::uint8_t> data, Reason condition,
                                 JointValue& value) noexcept {
        const bool restarted = std::exchange(position_restarted_, false);
        value.position_reason = encoder_fault_ ? Reason::encoder_fault : condition;
        value.position_reason = restarted ? Reason::device_restarted : value.position_reason;
        value.raw_zero = config_.position.extract_raw(data) == 0;
        value.position_rad = config_.position.extract(data);
        value.step_rad = config_.position.step();
        value.wrap_rad = config_.position.span();
        value.from_zero_rad = value.position_rad - config_.position.offset;
    }

    constexpr void read_effort(std::span<const std::uint8_t> data, Reason condition,
                               JointValue& value) noexcept {
        const bool restarted = std::exchange(effort_restarted_, false);
        value.effort_reason = device_fault_ ? Reason::device_fault : condition;
        value.effort_reason = restarted ? Reason::device_restarted : value.effort_reason;
        value.effort = config_.effort.extract(data);
        if (value.effort_reason == Reason::ok && config_.effort.is_at_end(data)) {
            value.effort_reason = Reason::output_saturated;
        }
    }

    /// Returns the reason for a value that may answer another SYNC.
    [[nodiscard]] static constexpr Reason refused(Reason reason) noexcept {
        return reason == Reason::ok ? Reason::sync_unknown : reason;
    }

    constexpr Decoded decode_sync(const Frame& frame) noexcept {
        if (frame.remote || frame.fd) {
            return rejected(Reason::wrong_frame_type);
        }
        if (frame.length > 1) { // one byte: the counter that some masters send
            return rejected(Reason::wrong_length);
        }
        synchronised_ = true;
        sync_ns_ = frame.stamp_ns;
        position_step_.sync(frame.stamp_ns);
        effort_step_.sync(frame.stamp_ns);
        Decoded decoded;
        decoded.kind = Decoded::Kind::sync;
        return decoded;
    }

    constexpr Decoded decode_heartbeat(const Frame& frame) noexcept {
        if (frame.remote) {
            return {};
        }
        if (const Reason fault = check_form(frame, 1); fault != Reason::ok) {
            return rejected(fault);
        }
        if (frame.data[0] == static_cast<std::uint8_t>(State::boot_up)) {
            return boot_up(frame.stamp_ns);
        }
        const bool operational = (frame.data[0] & 0x7F) == static_cast<std::uint8_t>(State::operational);
        const Reason condition = operational ? Reason::ok : Reason::device_not_operational;
        heartbeat_.heard(frame.stamp_ns, condition);
        return status(condition);
    }

    constexpr Decoded boot_up(std::int64_t stamp_ns) noexcept {
        heartbeat_.heard(stamp_ns, heartbeat_.expected() ? Reason::device_not_operational : Reason::ok);
        const bool interrupts = sending_;
        position_restarted_ = effort_restarted_ = interrupts;
        sending_ = encoder_fault_ = device_fault_ = false;
        return status(interrupts ? Reason::device_restarted : Reason::device_not_operational);
    }

    constexpr Decoded decode_emcy(const Frame& frame) noexcept {
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        const auto code = load_little<std::uint16_t>(frame.data.data());
        device_fault_ = code != 0;
        encoder_fault_ = code != 0 && (encoder_fault_ || code >> 8 == 0x73);
        return status(encoder_fault_  ? Reason::encoder_fault
                      : device_fault_ ? Reason::device_fault
                                      : Reason::ok);
    }

    Config config_;
    Heartbeat heartbeat_;
    SyncStep position_step_;
    SyncStep effort_step_;
    AnswerContents position_content_, effort_content_; ///< of the last PDOs
    std::int64_t sync_ns_ = 0;
    bool synchronised_ = false;
    bool encoder_fault_ = false;
    bool device_fault_ = false;
    bool sending_ = false;            ///< a PDO has arrived since the last boot-up
    bool position_restarted_ = false; ///< the drive has booted since its last position
    bool effort_restarted_ = false;
};

static_assert(JointSource<Cia402Drive>);

} // namespace dfdyn::hal
