// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"

#include <utility>

namespace dfdyn::hal {

/// An arm's output that its joints measure themselves: one torque (N·m) or current (A) per joint.
template <int n, int capacity>
class EffortOutput {
  public:
    static constexpr int outputs = n;

    struct Config {
        TrackConfig track;
        std::array<Range, static_cast<std::size_t>(n)> range;
    };

    explicit constexpr EffortOutput(const Config& config) noexcept
        : EffortOutput(config, std::make_index_sequence<static_cast<std::size_t>(n)>{}) {}

    /// No frame is for this output alone.
    constexpr Decoded take(const Frame& /*frame*/) noexcept { return {}; }

    /// The effort that comes with a joint, which must be one of the arm's. Zero is as good as any: it need
    /// not qualify.
    constexpr void take(const JointValue& value) noexcept {
        if (value.effort_reason != Reason::no_output) {
            track_[static_cast<std::size_t>(value.joint)].push(value.stamp_ns, value.effort_reason,
                                                               {value.effort}, false);
        }
    }

    [[nodiscard]] constexpr bool claims(std::uint32_t /*id*/) const noexcept { return false; }

    /// All efforts at an instant; the first reason of a joint. See Track.
    constexpr Measurement<n> at(std::int64_t instant_ns) noexcept {
        Measurement<n> all;
        for (std::size_t i = 0; i < track_.size(); ++i) {
            const Measurement<1> one = track_[i].at(instant_ns);
            all.reason = all.reason == Reason::ok ? one.reason : all.reason;
            all.value[i] = one.value[0];
            all.stamp_ns = i == 0 ? one.stamp_ns : std::min(all.stamp_ns, one.stamp_ns);
        }
        return all;
    }

    [[nodiscard]] constexpr bool heard() const noexcept {
        return std::ranges::all_of(track_, [](const auto& track) { return track.heard(); });
    }

    /// Of the joint that is behind the others. Requires `heard()`.
    [[nodiscard]] constexpr std::int64_t newest_ns() const noexcept {
        std::int64_t newest_ns = track_[0].newest_ns();
        for (const auto& track : track_) {
            newest_ns = std::min(newest_ns, track.newest_ns());
        }
        return newest_ns;
    }

    /// Nothing is pending.
    constexpr void lost() noexcept {}

    [[nodiscard]] constexpr const Track<1, capacity>& track(int joint) const noexcept {
        return track_[static_cast<std::size_t>(joint)];
    }

  private:
    template <std::size_t... i>
    constexpr EffortOutput(const Config& config, std::index_sequence<i...> /*joints*/) noexcept
        : track_{Track<1, capacity>(config.track, {config.range[i]}, output_reasons)...} {}

    std::array<Track<1, capacity>, static_cast<std::size_t>(n)> track_;
};

} // namespace dfdyn::hal
