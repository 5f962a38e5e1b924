// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_arrival.hpp"
#include "dfdyn/hal/assembly/joint_count.hpp"
#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/gate/frozen_effort.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace dfdyn::hal {

/// The output of an arm that its joints measure: one torque (N·m) or current (A) per joint. The rate of
/// change of a motor current has no limit, so that no step is rejected.
template <int n, int capacity>
class EffortOutput {
  public:
    static constexpr int outputs = n;

    struct Config {
        TrackConfig track;
        PerJoint<Range, n> range;
        int frozen_limit = 100; ///< periods with the same value in motion, see FrozenEffortGate
        Extent<n> joints{};
    };

    explicit constexpr EffortOutput(const Config& config) noexcept
        : EffortOutput(config, std::make_index_sequence<static_cast<std::size_t>(places(n))>{}) {}

    [[nodiscard]] constexpr Extent<n> size() const noexcept { return joints_; }

    /// Ignores frames, because no frame is for this output alone.
    constexpr Decoded take(const Frame& /*frame*/) noexcept { return {}; }

    /// Takes the effort that a joint sends with its position. The joint must belong to the arm. Zeros are
    /// valid, so that the source need not qualify. `position_rad`: last trusted position of the joint;
    /// none before the first, when no effort counts as frozen.
    constexpr void take(const JointValue& value, std::optional<double> position_rad) noexcept {
        if (value.effort_reason == Reason::no_output) {
            return;
        }
        const auto joint = static_cast<std::size_t>(value.joint);
        Reason reason = value.effort_reason;
        const bool later = track_[joint].is_later(value.stamp_ns);
        const Reason arrival = later ? arrival_[joint].take(value.stamp_ns) : Reason::ok;
        if (reason == Reason::ok || arrival == Reason::id_collision) {
            reason = arrival;
        }
        const bool known = later && position_rad && value.effort_reason == Reason::ok; // from any sender
        if (known && frozen_[joint].frozen(value.effort, *position_rad, value.stamp_ns) &&
            reason == Reason::ok) {
            reason = Reason::output_frozen;
        }
        track_[joint].push(value.stamp_ns, reason, {value.effort}, false);
    }

    [[nodiscard]] constexpr bool claims(std::uint32_t /*id*/) const noexcept { return false; }

    /// Returns all efforts at a time; the reason is that of the first joint with one. See Track.
    constexpr Measurement<places(n)> at(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
        Measurement<places(n)> all;
        for (std::size_t i = 0; i < used(); ++i) {
            const Measurement<1> one = track_[i].at(instant_ns, now_ns);
            all.reason = all.reason == Reason::ok ? one.reason : all.reason;
            all.value[i] = one.value[0];
            all.stamp_ns = i == 0 ? one.stamp_ns : std::min(all.stamp_ns, one.stamp_ns);
        }
        return all;
    }

    /// Returns the least direct origin of all joints.
    [[nodiscard]] constexpr ValueOrigin origin(std::int64_t instant_ns) const noexcept {
        ValueOrigin all = track_[0].origin(instant_ns);
        for (std::size_t i = 0; i < used(); ++i) {
            all = std::max(all, track_[i].origin(instant_ns));
        }
        return all;
    }

    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        return std::any_of(track_.begin(), track_.begin() + joints_,
                           [&](const auto& track) { return track.pending(instant_ns, now_ns); });
    }

    [[nodiscard]] constexpr bool heard() const noexcept {
        return std::all_of(track_.begin(), track_.begin() + joints_,
                           [](const auto& track) { return track.heard(); });
    }

    /// Returns the newest stamp of the joint that is furthest behind. Requires `heard()`.
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept {
        std::int64_t newest_ns = track_[0].newest_ns();
        for (std::size_t i = 0; i < used(); ++i) {
            newest_ns = std::min(newest_ns, track_[i].newest_ns());
        }
        return newest_ns;
    }

    /// Returns the period of its measurements; 0: unknown.
    [[nodiscard]] constexpr std::int64_t period_ns() const noexcept { return track_[0].period_ns(); }

    /// Does nothing, because no half is pending.
    constexpr void lost() noexcept {}

    /// Gate of a joint's effort, with the number of times it froze.
    [[nodiscard]] constexpr const FrozenEffortGate& frozen(int joint) const noexcept {
        return frozen_[static_cast<std::size_t>(joint)];
    }

    [[nodiscard]] constexpr const Track<1, capacity>& track(int joint) const noexcept {
        return track_[static_cast<std::size_t>(joint)];
    }

  private:
    template <std::size_t... i>
    constexpr EffortOutput(const Config& config, std::index_sequence<i...> /*places*/) noexcept
        : joints_(config.joints), track_{Track<1, capacity>(config.track, {config.range[i]},
                                                            output_reasons)...},
          frozen_{(static_cast<void>(i), FrozenEffortGate(config.frozen_limit, config.track.period_ns))...},
          arrival_{(static_cast<void>(i), JointArrival(config.track.period_ns))...} {}

    [[nodiscard]] constexpr std::size_t used() const noexcept { return static_cast<std::size_t>(joints_); }

    [[no_unique_address]] Extent<n> joints_;
    PerJoint<Track<1, capacity>, n> track_;
    PerJoint<FrozenEffortGate, n> frozen_;
    PerJoint<JointArrival, n> arrival_;
};

} // namespace dfdyn::hal
