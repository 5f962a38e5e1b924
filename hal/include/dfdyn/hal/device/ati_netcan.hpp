// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/device/six_equations.hpp"

namespace dfdyn::hal {

/// An ATI force/torque sensor with a NETCANOEM or NetCAN board. It sends strain gauge counts, not a wrench.
/// Frames by identifier, where B is the base; contents are big-endian:
/// - 16 B, 0 bytes: a poll by the host
/// - 16 B, 8 bytes: status u16, gauges 0, 2, 4 (int16)
/// - 16 B + 1, 6 bytes: gauges 1, 3, 5 (int16)
///
/// wrench = matrix * gauges / counts per unit. The sensor does not report saturation; a gauge at the end of
/// its range is saturated and affects all six values.
class AtiNetcan {
  public:
    struct Config {
        std::uint32_t base = 0x20;
        std::array<SixValues, 6> matrix{}; ///< calibration matrix of this individual sensor, one row per axis
        double counts_per_newton = 0;      ///< 0: unknown
        double counts_per_newton_metre = 0;
    };

    explicit AtiNetcan(const Config& config) noexcept : config_(config), calibration_(check(config)) {}

    /// Returns ok if matrix and counts are known and plausible, otherwise the reason.
    [[nodiscard]] constexpr Reason calibration() const noexcept { return calibration_; }

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept {
        return id == first_id() || id == second_id();
    }

    [[nodiscard]] constexpr Decoded decode(const Frame& frame) const noexcept {
        const bool first = has_id(frame, first_id());
        const bool poll = first && frame.length == 0;
        if (poll || (!first && !has_id(frame, second_id()))) {
            return {};
        }
        const Reason fault = check_form(frame, first ? 8 : 6);
        return fault != Reason::ok ? rejected(fault) : wrench_part(first ? 0 : 1);
    }

    [[nodiscard]] WrenchReading wrench(const Frame& first, const Frame& second) const noexcept {
        WrenchReading reading;
        for (std::size_t i = 0; i < 6; ++i) {
            const Frame& frame = i % 2 == 0 ? first : second;
            reading.raw[i] = load_big<std::int16_t>(frame.data.data() + gauge_place(i));
        }
        for (std::size_t axis = 0; axis < 6; ++axis) {
            double counts = 0;
            for (std::size_t i = 0; i < 6; ++i) {
                counts += config_.matrix[axis][i] * reading.raw[i];
            }
            reading.value[axis] = counts / counts_per_unit(axis);
        }
        reading.reason = calibration();
        if (reading.reason == Reason::ok && (load_big<std::uint16_t>(first.data.data()) & fault_bits) != 0) {
            reading.reason = Reason::device_fault;
        }
        return reading;
    }

    /// Returns the frame that requests one wrench.
    [[nodiscard]] constexpr Frame poll() const noexcept { return make_frame(first_id(), 0); }

    /// Encodes a wrench (N, N·m). All gauges are 0 without a valid calibration. Gauges saturate like the
    /// converter.
    [[nodiscard]] FrameList encode(const Wrench& value) const noexcept {
        FrameList frames;
        frames.count = 2;
        frames.frame = {make_frame(first_id(), 8), make_frame(second_id(), 6)};
        SixValues counts{};
        for (std::size_t axis = 0; axis < 6; ++axis) {
            counts[axis] = value[axis] * counts_per_unit(axis);
        }
        const auto gauges = calibration() == Reason::ok ? solve(config_.matrix, counts) : std::nullopt;
        for (std::size_t i = 0; i < 6 && gauges; ++i) {
            store_big(frames.frame[i % 2].data.data() + gauge_place(i),
                      saturated<std::int16_t>((*gauges)[i]));
        }
        return frames;
    }

  private:
    /// Bit 15: any error, 14: CAN error, 12 and 11: temperature, 7 … 3: critical errors.
    static constexpr unsigned fault_bits = 0xD8F8;

    /// Offset of the gauge in its frame: even gauges follow the status word, odd gauges fill their own frame.
    [[nodiscard]] static constexpr std::size_t gauge_place(std::size_t gauge) noexcept {
        return gauge % 2 == 0 ? 2 + gauge : gauge - 1;
    }

    [[nodiscard]] constexpr std::uint32_t first_id() const noexcept { return config_.base << 4; }
    [[nodiscard]] constexpr std::uint32_t second_id() const noexcept { return config_.base << 4 | 1; }

    [[nodiscard]] constexpr double counts_per_unit(std::size_t axis) const noexcept {
        return axis < 3 ? config_.counts_per_newton : config_.counts_per_newton_metre;
    }

    [[nodiscard]] static Reason check(const Config& config) noexcept {
        const double force = config.counts_per_newton;
        const double torque = config.counts_per_newton_metre;
        if (force == 0 || torque == 0) {
            return Reason::waiting_for_full_scale;
        }
        const bool sound = force > 0 && torque > 0 && std::isfinite(force) && std::isfinite(torque);
        return sound && solve(config.matrix, {}) ? Reason::ok : Reason::full_scale_implausible;
    }

    Config config_;
    Reason calibration_;
};

static_assert(WrenchSource<AtiNetcan>);

} // namespace dfdyn::hal
