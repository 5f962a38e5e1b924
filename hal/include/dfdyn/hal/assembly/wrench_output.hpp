// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/extent.hpp"
#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/gate/frozen_wrench.hpp"
#include "dfdyn/hal/gate/jump.hpp"
#include "dfdyn/hal/gate/pairing.hpp"
#include "dfdyn/hal/gate/saturation.hpp"

#include <algorithm>
#include <optional>

namespace dfdyn::hal {

/// The output of an arm that a force/torque sensor measures: frames to checked wrenches.
template <WrenchSource Source, int capacity>
class WrenchOutput {
  public:
    static constexpr int outputs = 6;

    struct Config {
        TrackConfig track;
        typename RangeGate<6>::Ranges range; ///< of the sensor
        PairGate::Config pairing;            ///< of the two frames of a wrench
        int frozen_limit;                    ///< identical readings, see FrozenWrenchGate
    };

    // A small stack has no room for a copy: NOLINTNEXTLINE(modernize-pass-by-value)
    constexpr WrenchOutput(const Source& source, const Config& config) noexcept
        : source_(source), pairing_(config.pairing), frozen_(config.frozen_limit, config.track.period_ns),
          jump_(config.track.max_age_ns), track_(config.track, config.range, output_reasons) {}

    [[nodiscard]] static constexpr Extent<outputs> size() noexcept { return {}; }

    /// Decodes a frame, and takes the wrench that it completes.
    constexpr Decoded take(const Frame& frame) noexcept {
        const Decoded decoded = source_.decode(frame);
        if (decoded.kind != Decoded::Kind::part) {
            return decoded;
        }
        switch (pairing_.push(decoded.part, frame)) {
        case PairGate::Result::waiting:
            break;
        case PairGate::Result::paired:
            push(source_.wrench(pairing_.first(), pairing_.second()));
            break;
        case PairGate::Result::orphaned:
            track_.push(pairing_.orphan_ns(), Reason::output_incomplete, {}, false);
            break;
        case PairGate::Result::doubled:
            collision_.seen(true);
            track_.push(frame.stamp_ns, Reason::id_collision, {}, false);
            break;
        }
        return decoded;
    }

    /// Ignores values of joints, which do not measure a wrench.
    constexpr void take(const JointValue& /*value*/, std::optional<double> /*position_rad*/) noexcept {}

    [[nodiscard]] constexpr bool claims(std::uint32_t id) const noexcept { return source_.claims(id); }

    /// See Track.
    constexpr Measurement<6> at(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
        return track_.at(instant_ns, now_ns);
    }
    [[nodiscard]] constexpr ValueOrigin origin(std::int64_t instant_ns) const noexcept {
        return track_.origin(instant_ns);
    }
    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        return track_.pending(instant_ns, now_ns);
    }
    [[nodiscard]] constexpr bool heard() const noexcept { return track_.heard(); }
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept { return track_.newest_ns(); }

    /// Returns the period of its measurements; 0: unknown.
    [[nodiscard]] constexpr std::int64_t period_ns() const noexcept { return track_.period_ns(); }

    /// Discards a pending half after a loss of frames.
    constexpr void lost() noexcept { pairing_.reset(); }

    /// The sensor's decoder, with its requests and the values that the sensor reported, such as full scales.
    [[nodiscard]] constexpr const Source& source() const noexcept { return source_; }
    [[nodiscard]] constexpr const Track<6, capacity>& track() const noexcept { return track_; }
    [[nodiscard]] constexpr const PairGate& pairing() const noexcept { return pairing_; }
    [[nodiscard]] constexpr const SaturationGate& saturation() const noexcept { return saturation_; }
    [[nodiscard]] constexpr const FrozenWrenchGate<6>& frozen() const noexcept { return frozen_; }

  private:
    /// Passes a reading to all gates, also if one rejects it. The first rejection is the reason.
    constexpr void push(const WrenchReading& reading) noexcept {
        const bool zero = std::ranges::all_of(reading.raw, [](std::int32_t raw) { return raw == 0; });
        const bool flagged = reading.reason == Reason::output_saturated;
        const bool saturated = saturation_.saturated(flagged, reading.raw);
        const bool frozen = frozen_.frozen(reading.raw, pairing_.first().stamp_ns);
        Reason reason = reading.reason;
        if (reason == Reason::ok && saturated) {
            reason = Reason::output_saturated;
        }
        if (reason == Reason::ok && frozen) {
            reason = Reason::output_frozen;
        }
        if (reason == Reason::ok && collision_.seen(false)) {
            reason = Reason::id_collision;
        }
        if (reason == Reason::ok && !zero && track_.range().contains(reading.value) &&
            jump_.jumps(reading.value, pairing_.first().stamp_ns)) {
            reason = Reason::output_jump;
        }
        if (zero) { // all six, to the last bit: the sensor has just started
            track_.disqualify();
        }
        track_.push(pairing_.first().stamp_ns, reason, reading.value, zero);
    }

    Source source_;
    PairGate pairing_;
    SaturationGate saturation_;
    FrozenWrenchGate<6> frozen_;
    JumpGate<6> jump_;
    CollisionHold collision_;
    Track<6, capacity> track_;
};

} // namespace dfdyn::hal
