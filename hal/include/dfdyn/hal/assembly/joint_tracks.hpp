// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_count.hpp"
#include "dfdyn/hal/assembly/position_track.hpp"
#include "dfdyn/hal/clock/clock_step.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace dfdyn::hal {

/// The recent positions of all joints of an arm. A clock step too small for ClockGate offsets each joint by
/// its own velocity. If all sources show the same step, the joints are trusted again.
template <int n, int capacity>
class JointTracks {
  public:
    constexpr JointTracks(Extent<n> joints, const TrackConfig& config, const PerJoint<Range, n>& range,
                          const PerJoint<MotionLimits, n>& limits) noexcept
        : JointTracks(joints, config, range, limits,
                      std::make_index_sequence<static_cast<std::size_t>(places(n))>{}) {}

    /// Takes a device's value of a joint, 0 … n - 1. Returns ok, or the reason of the rejection.
    constexpr Reason push(const JointValue& value) noexcept {
        PositionTrack<capacity>& track = track_[static_cast<std::size_t>(value.joint)];
        steps_.take(value.joint, value.stamp_ns, period_ns_, jitter_ns_);
        const Reason reason = track.push(value);
        follow_clock(track, value.stamp_ns);
        return reason;
    }

    /// Takes the stamp of the arm's sensor, which also shows clock steps.
    constexpr void sensor_measured(std::int64_t stamp_ns, std::int64_t period_ns) noexcept {
        steps_.take(places(n), stamp_ns, period_ns, jitter_ns_);
    }

    /// Notes a clock step: the time since the last positions is unknown.
    constexpr void clock_set() noexcept {
        for (PositionTrack<capacity>& track : track_) {
            track.motion().forget_time();
        }
    }

    /// Returns true if a position at this time is missing and may still be interpolated.
    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        return std::any_of(track_.begin(), track_.begin() + joints_,
                           [&](const auto& track) { return track.pending(instant_ns, now_ns); });
    }

    [[nodiscard]] constexpr PositionTrack<capacity>& operator[](std::size_t joint) noexcept {
        return track_[joint];
    }
    [[nodiscard]] constexpr const PositionTrack<capacity>& operator[](std::size_t joint) const noexcept {
        return track_[joint];
    }

  private:
    template <std::size_t... i>
    constexpr JointTracks(Extent<n> joints, const TrackConfig& config, const PerJoint<Range, n>& range,
                          const PerJoint<MotionLimits, n>& limits,
                          std::index_sequence<i...> /*places*/) noexcept
        : joints_(joints), track_{PositionTrack<capacity>(config, range[i], limits[i])...},
          period_ns_(config.period_ns), jitter_ns_(config.jitter_ns) {}

    constexpr void follow_clock(PositionTrack<capacity>& track, std::int64_t stamp_ns) noexcept {
        const std::int64_t tolerance_ns = 2 * jitter_ns_;
        if (period_ns_ <= 0 || !track.motion().lost()) { // no joint shows a step if its period is unknown
            return;
        }
        if (const auto step_ns = steps_.step_ns(stamp_ns, tolerance_ns)) {
            track.motion().explain_by_clock(*step_ns);
            track.motion().explain_by_clock(steps_.within_period(*step_ns, period_ns_));
        }
    }

    [[no_unique_address]] Extent<n> joints_;
    PerJoint<PositionTrack<capacity>, n> track_;
    ClockStepWatch<places(n) + 1> steps_;
    std::int64_t period_ns_;
    std::int64_t jitter_ns_;
};

} // namespace dfdyn::hal
