// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"
#include "dfdyn/hal/reason.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Full scales of a sensor's channels, from its description or from its own reports. They are not valid until
/// all are known and plausible. With a full scale of 0 every wrench is zero; with a default, or the value of
/// another calibration, it is wrong by a factor. So a report never replaces a full scale silently:
/// - if it contradicts the description, none is valid until a report of that channel agrees with it;
/// - if it contradicts an earlier report, none is valid until all channels were reported again consistently.
template <int channels>
class FullScaleGate {
  public:
    struct Range {
        double lowest;
        double highest;
    };
    using Ranges = std::array<Range, static_cast<std::size_t>(channels)>;

    explicit constexpr FullScaleGate(const Ranges& plausible) noexcept : plausible_(plausible) {}

    /// Sets a full scale from the sensor's description. A channel outside 0 … channels-1 is ignored.
    constexpr void describe(int channel, double full_scale) noexcept {
        if (has(channel)) {
            channel_[static_cast<std::size_t>(channel)] = {full_scale, true, true, false};
        }
    }

    /// Takes a full scale that the sensor reports. A channel outside 0 … channels-1 is ignored.
    constexpr void report(int channel, double full_scale) noexcept {
        if (!has(channel)) {
            return;
        }
        Channel& mine = channel_[static_cast<std::size_t>(channel)];
        const bool agrees = !mine.known || mine.value == full_scale;
        changed_ += agrees ? 0U : 1U;
        if (mine.described) {
            mine.in_doubt = !agrees;
            return;
        }
        for (Channel& other : channel_) {
            other.in_doubt = other.in_doubt || (!agrees && !other.described);
        }
        mine = {full_scale, true, false, false};
    }

    [[nodiscard]] constexpr Reason reason() const noexcept {
        Reason reason = Reason::ok;
        for (std::size_t i = 0; i < channel_.size(); ++i) {
            const Channel& one = channel_[i];
            if (!one.known) {
                reason = Reason::waiting_for_full_scale;
            } else if (!(one.value >= plausible_[i].lowest && one.value <= plausible_[i].highest)) {
                return Reason::full_scale_implausible;
            } else if (one.in_doubt && reason == Reason::ok) {
                reason = Reason::full_scale_contradicted;
            }
        }
        return reason;
    }

    /// Returns the full scale of a channel; valid while `reason()` is ok.
    [[nodiscard]] constexpr double operator[](std::size_t channel) const noexcept {
        return channel_[channel].value;
    }

    /// Returns true if the channel is known and has this full scale.
    [[nodiscard]] constexpr bool agrees(int channel, double full_scale) const noexcept {
        return has(channel) && channel_[static_cast<std::size_t>(channel)].known &&
               channel_[static_cast<std::size_t>(channel)].value == full_scale;
    }

    /// Returns the number of reports that differ from the one before, or from the description.
    [[nodiscard]] constexpr std::uint64_t changed() const noexcept { return changed_; }

  private:
    struct Channel {
        double value = 0;
        bool known = false;
        bool described = false;
        bool in_doubt = false; ///< contradicted, and not yet confirmed by another report
    };

    [[nodiscard]] static constexpr bool has(int channel) noexcept {
        return channel >= 0 && channel < channels;
    }

    Ranges plausible_;
    std::array<Channel, static_cast<std::size_t>(channels)> channel_{};
    std::uint64_t changed_ = 0;
};

} // namespace dfdyn::hal
