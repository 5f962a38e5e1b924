// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"

namespace dfdyn::hal {

/// A Robotous RFT sensor. It sends a record of 16 bytes in two frames of 8; the two bytes of Tx are in
/// different frames. Contents are big-endian:
/// - first identifier: 0x0B, Fx, Fy, Fz (int16), high byte of Tx
/// - second identifier: low byte of Tx, Ty, Tz (int16), overload bits, 2 bytes
///
/// The identifiers are configured in the sensor. Each axis has an overload bit, which is set at 120 % of its
/// range.
class RobotousRft {
  public:
    struct Config {
        std::uint32_t first_id = 0xF9;
        std::uint32_t second_id = 0xFA;
        double counts_per_newton = 50;
        double counts_per_newton_metre = 2000; ///< 1000 for the larger models
    };

    explicit constexpr RobotousRft(const Config& config) noexcept : config_(config) {}

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == config_.first_id || id == config_.second_id;
    }

    /// Ignores replies to other commands, which have another first byte.
    [[nodiscard]] constexpr Decoded decode(const Frame& frame) const noexcept {
        const bool first = has_id(frame, config_.first_id);
        if (!first && !has_id(frame, config_.second_id)) {
            return {};
        }
        if (const Reason fault = check_form(frame, 8); fault != Reason::ok) {
            return rejected(fault);
        }
        return first && frame.data[0] != continuous_output ? Decoded{} : wrench_part(first ? 0 : 1);
    }

    [[nodiscard]] constexpr WrenchReading wrench(const Frame& first, const Frame& second) const noexcept {
        std::array<std::uint8_t, 16> record{};
        std::copy_n(first.data.begin(), 8, record.begin());
        std::copy_n(second.data.begin(), 8, record.begin() + 8);
        WrenchReading reading;
        for (std::size_t i = 0; i < 6; ++i) {
            reading.raw[i] = load_big<std::int16_t>(record.data() + 1 + 2 * i);
            reading.value[i] = reading.raw[i] / counts_per_unit(i);
        }
        if ((record[overload_byte] & all_axes) != 0) {
            reading.reason = Reason::output_saturated;
        }
        return reading;
    }

    /// Returns the frame that starts continuous transmission; `command_id` as configured in the sensor.
    [[nodiscard]] static constexpr Frame start(std::uint32_t command_id) noexcept {
        Frame frame = make_frame(command_id, 8);
        frame.data[0] = continuous_output;
        return frame;
    }

    /// Encodes a wrench. An axis at the end of its integer range is marked as overloaded.
    [[nodiscard]] FrameList encode(const Wrench& value) const noexcept {
        std::array<std::uint8_t, 16> record{continuous_output};
        for (std::size_t i = 0; i < 6; ++i) {
            const double counts = value[i] * counts_per_unit(i);
            store_big(record.data() + 1 + 2 * i, saturated<std::int16_t>(counts));
            record[overload_byte] |= static_cast<std::uint8_t>(std::abs(counts) >= 32767 ? 0x20U >> i : 0U);
        }
        FrameList frames;
        frames.count = 2;
        frames.frame = {make_frame(config_.first_id, 8), make_frame(config_.second_id, 8)};
        std::copy_n(record.begin(), 8, frames.frame[0].data.begin());
        std::copy_n(record.begin() + 8, 8, frames.frame[1].data.begin());
        return frames;
    }

  private:
    static constexpr std::uint8_t continuous_output = 0x0B;
    static constexpr std::size_t overload_byte = 13;
    static constexpr unsigned all_axes = 0x3F;

    [[nodiscard]] constexpr double counts_per_unit(std::size_t channel) const noexcept {
        return channel < 3 ? config_.counts_per_newton : config_.counts_per_newton_metre;
    }

    Config config_;
};

static_assert(WrenchSource<RobotousRft>);

} // namespace dfdyn::hal
