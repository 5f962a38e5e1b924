// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/icub_id.hpp"
#include "dfdyn/hal/gate/full_scale.hpp"

namespace dfdyn::hal::icub {

/// The iCub's force/torque board (strain, strain2). Frames by identifier, where A is the address:
/// - 0x30A + 16 A, 6 or 7 bytes: force x y z: u16 little-endian, offset binary (0x8000 is 0)
/// - 0x30B + 16 A, 6 or 7 bytes: torque x y z in the same format
/// - 0x200 + A, to the board, 2 bytes: 0x18, channel: requests a full scale
/// - 0x200 + 16 A, from the board, 4 bytes: 0x18, set and channel (nibbles), full scale (N, N·m) u16
///   big-endian
///
/// The seventh byte is present only while a strain gauge is saturated. The board then repeats its last good
/// wrench, so such a frame is old regardless of its time stamp. A gauge affects all six values. There is no
/// wrench before all six full scales are known: send `request_full_scale` until `full_scale().reason()` is
/// ok.
///
/// A strain2 has several calibration sets. A reply is used only if it belongs to the set in use, which is
/// number 0 in requests and replies, or the number given to `use_calibration_set`. A reply about another set,
/// requested by another program, is counted (`other_sets`) and changes nothing.
class StrainBoard {
  public:
    using FullScale = FullScaleGate<6>;

    /// Plausible full scales of a sensor in an arm. The board's factory default, 32767, is not plausible.
    static constexpr FullScale::Ranges plausible_ranges{
        {{10, 10000}, {10, 10000}, {10, 10000}, {0.5, 1000}, {0.5, 1000}, {0.5, 1000}}};

    explicit constexpr StrainBoard(int address,
                                   const FullScale::Ranges& plausible = plausible_ranges) noexcept
        : address_(address), full_scale_(plausible) {}

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == force_id() || id == torque_id() || id == reply_id();
    }

    constexpr Decoded decode(const Frame& frame) noexcept {
        if (has_id(frame, force_id()) || has_id(frame, torque_id())) {
            const Reason fault = check_form(frame, frame.length == 7 ? 7 : 6);
            return fault != Reason::ok ? rejected(fault) : wrench_part(frame.id == force_id() ? 0 : 1);
        }
        return has_id(frame, reply_id()) ? decode_reply(frame) : Decoded{};
    }

    [[nodiscard]] constexpr WrenchReading wrench(const Frame& force, const Frame& torque) const noexcept {
        WrenchReading reading;
        for (std::size_t i = 0; i < 6; ++i) {
            const std::uint8_t* bytes = (i < 3 ? force : torque).data.data() + 2 * (i % 3);
            reading.raw[i] = load_little<std::uint16_t>(bytes) - half_range;
            reading.value[i] = reading.raw[i] * full_scale_[i] / half_range;
        }
        const bool saturated = force.length == 7 || torque.length == 7;
        reading.reason = full_scale_.reason();
        if (reading.reason == Reason::ok && saturated) {
            reading.reason = Reason::output_saturated;
        }
        return reading;
    }

    /// Returns the frame that requests the full scale of a channel, 0 … 5.
    [[nodiscard]] constexpr Frame request_full_scale(int channel) const noexcept {
        Frame frame = make_frame(polling_analog_class | (static_cast<std::uint32_t>(address_) & 0xFU), 2);
        frame.data[0] = get_full_scale;
        frame.data[1] = static_cast<std::uint8_t>(channel);
        return frame;
    }

    [[nodiscard]] constexpr const FullScale& full_scale() const noexcept { return full_scale_; }

    /// Sets the described full scale of a channel, 0 … 5. The board's reports must agree with it.
    constexpr void describe_full_scale(int channel, double full_scale) noexcept {
        full_scale_.describe(channel, full_scale);
    }

    /// Sets the number of the calibration set in use: 1 … 15, or 0 if the board's replies do not contain it.
    constexpr void use_calibration_set(int set) noexcept { set_ = set; }

    /// Number of reported full scales of other sets that differ from those in use, and the set of the last
    /// one.
    [[nodiscard]] constexpr std::uint64_t other_sets() const noexcept { return other_sets_; }
    [[nodiscard]] constexpr int last_other_set() const noexcept { return last_other_set_; }

    /// Encodes the board's answer to such a request, for a calibration set.
    [[nodiscard]] Frame encode_full_scale(int channel, double full_scale, int set = 0) const noexcept {
        Frame frame = make_frame(reply_id(), 4);
        frame.data[0] = get_full_scale;
        frame.data[1] = static_cast<std::uint8_t>(set << 4 | channel);
        store_big(frame.data.data() + 2, hal::saturated<std::uint16_t>(full_scale));
        return frame;
    }

    /// Encodes a wrench with the known full scales. All values are zero before these are known. Values beyond
    /// the full scale are clamped and marked as saturated.
    [[nodiscard]] FrameList encode(const Wrench& value) const noexcept {
        bool beyond = false;
        for (std::size_t i = 0; i < 6; ++i) {
            beyond = beyond || std::abs(value[i]) >= full_scale_[i];
        }
        return encode(value, beyond && full_scale_.reason() == Reason::ok);
    }

    /// Encodes the frames of a saturated board; `value` is the last good wrench.
    [[nodiscard]] FrameList encode(const Wrench& value, bool saturated) const noexcept {
        FrameList frames;
        frames.count = 2;
        const int length = saturated ? 7 : 6;
        frames.frame = {make_frame(force_id(), length), make_frame(torque_id(), length)};
        for (std::size_t i = 0; i < 6; ++i) {
            const bool known = full_scale_.reason() == Reason::ok;
            const double steps = known ? value[i] / full_scale_[i] * half_range : 0;
            store_little(frames.frame[i / 3].data.data() + 2 * (i % 3),
                         hal::saturated<std::uint16_t>(steps + half_range));
        }
        for (Frame& frame : frames.frame) {
            frame.data[6] = saturated ? one_channel_high : 0;
        }
        return frames;
    }

  private:
    static constexpr std::uint8_t get_full_scale = 0x18;
    static constexpr std::uint8_t one_channel_high =
        0b0000'1010; // two bits each: some channel is too high, the first channel of the frame is too high
    static constexpr int half_range = 0x8000;

    [[nodiscard]] constexpr std::uint32_t force_id() const noexcept {
        return identifier(periodic_analog_class, address_, 0xA);
    }
    [[nodiscard]] constexpr std::uint32_t torque_id() const noexcept {
        return identifier(periodic_analog_class, address_, 0xB);
    }
    [[nodiscard]] constexpr std::uint32_t reply_id() const noexcept {
        return identifier(polling_analog_class, address_, 0);
    }

    /// The board answers other requests on this identifier as well.
    constexpr Decoded decode_reply(const Frame& frame) noexcept {
        if (frame.length == 0 || frame.data[0] != get_full_scale) {
            return {};
        }
        if (const Reason fault = check_form(frame, 4); fault != Reason::ok) {
            return rejected(fault);
        }
        const int set = frame.data[1] >> 4;
        const int channel = frame.data[1] & 0x0F;
        const double value = load_big<std::uint16_t>(frame.data.data() + 2);
        if (set == 0 || set == set_) {
            full_scale_.report(channel, value);
        } else if (!full_scale_.agrees(channel, value)) {
            ++other_sets_;
            last_other_set_ = set;
        }
        return status(full_scale_.reason());
    }

    int address_;
    FullScale full_scale_;
    int set_ = 0;
    int last_other_set_ = 0;
    std::uint64_t other_sets_ = 0;
};

static_assert(WrenchSource<StrainBoard>);

} // namespace dfdyn::hal::icub
