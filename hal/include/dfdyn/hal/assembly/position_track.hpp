// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_arrival.hpp"
#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/motion/motion.hpp"
#include "dfdyn/hal/motion/velocity_witness.hpp"

namespace dfdyn::hal {

/// The recent positions of one joint that come from one sender, were read in time (JointArrival), and agree
/// with the joint's motion (MotionGate) and its velocity (VelocityWitness).
template <int capacity>
class PositionTrack {
  public:
    constexpr PositionTrack(const TrackConfig& config, const Range& range,
                            const MotionLimits& limits) noexcept
        : track_(without_qualification(config), {range}, position_reasons),
          motion_(
              {limits, range, config.max_age_ns, config.period_ns, config.jitter_ns, config.qualification}),
          arrival_(config.period_ns), latency_ns_(config.latency_ns) {}

    /// Takes a device's value of this joint's position. Returns ok, or the reason of the rejection.
    constexpr Reason push(const JointValue& value) noexcept {
        if (!track_.is_later(value.stamp_ns)) {
            EncoderReading repeated = reading_of(value); // in the turn of the stored value
            unwrap_near(repeated, motion_.position_rad().value_or(repeated.position_rad));
            track_.push(value.stamp_ns, value.position_reason, {repeated.position_rad}, false);
            return Reason::time_not_increasing;
        }
        const MotionGate::Verdict verdict = judge(value, arrival_.take(value.stamp_ns));
        track_.push(value.stamp_ns, verdict.reason, {verdict.position_rad}, false);
        return verdict.reason;
    }

    /// See Track.
    constexpr Measurement<1> at(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
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
    [[nodiscard]] constexpr const StalenessGate& staleness() const noexcept { return track_.staleness(); }
    [[nodiscard]] constexpr const GapGate& gap() const noexcept { return track_.gap(); }
    [[nodiscard]] constexpr std::uint64_t not_later() const noexcept { return track_.not_later(); }

    [[nodiscard]] constexpr MotionGate& motion() noexcept { return motion_; }
    [[nodiscard]] constexpr const MotionGate& motion() const noexcept { return motion_; }

    /// Returns how many times a second sender was detected.
    [[nodiscard]] constexpr std::uint64_t collisions() const noexcept { return arrival_.collisions(); }

  private:
    /// `arrival`: result of JointArrival.
    constexpr MotionGate::Verdict judge(const JointValue& value, Reason arrival) noexcept {
        const EncoderReading reading = reading_of(value);
        const bool collides = arrival == Reason::id_collision;
        if (collides) {
            motion_.contradict();
        }
        const Reason reason =
            value.position_reason == Reason::ok && !collides ? arrival : value.position_reason;
        if (reason == Reason::sync_unknown || reason == Reason::frame_waited) {
            motion_.glance(reading); // its time is unknown
            return {reason, value.position_rad};
        }
        if (reason != Reason::ok) {
            motion_.interrupt(reading);
            return {reason, value.position_rad};
        }
        if (witness_.contradicts(value)) {
            motion_.interrupt(reading);
            return {Reason::velocity_contradicts, value.position_rad};
        }
        MotionGate::Verdict verdict = motion_.take(reading);
        verdict.reason = collides ? Reason::id_collision : verdict.reason;
        return verdict;
    }

    [[nodiscard]] constexpr EncoderReading reading_of(const JointValue& value) const noexcept {
        return {.stamp_ns = value.stamp_ns - latency_ns_,
                .position_rad = value.position_rad,
                .step_rad = value.step_rad,
                .wrap_rad = value.wrap_rad,
                .from_zero_rad = value.from_zero_rad,
                .zero = value.raw_zero};
    }

    /// Switches the track's qualification off, because MotionGate qualifies.
    [[nodiscard]] static constexpr TrackConfig without_qualification(TrackConfig config) noexcept {
        config.qualification = {.readings = 0, .zero_readings = 0};
        return config;
    }

    Track<1, capacity> track_;
    MotionGate motion_;
    VelocityWitness witness_;
    JointArrival arrival_;
    std::int64_t latency_ns_;
};

} // namespace dfdyn::hal
