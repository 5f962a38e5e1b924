// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/reason.hpp"
#include "dfdyn/strict_math.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// The full scales of a sensor's channels, as the sensor reports them. Gives none until all are known and can
/// be: with a full scale of 0 a wrench looks healthy and is nothing, with a default it is off by a factor.
template <int channels>
class FullScaleGate {
  public:
    struct Range {
        double lowest;
        double highest;
    };
    using Ranges = std::array<Range, static_cast<std::size_t>(channels)>;

    explicit constexpr FullScaleGate(const Ranges& plausible) noexcept : plausible_(plausible) {}

    /// Channel 0 … channels-1; another is ignored. The last report counts.
    constexpr void report(int channel, double full_scale) noexcept {
        if (channel < 0 || channel >= channels) {
            return;
        }
        const auto index = static_cast<std::size_t>(channel);
        changed_ += known_[index] && value_[index] != full_scale ? 1U : 0U;
        known_[index] = true;
        value_[index] = full_scale;
    }

    [[nodiscard]] constexpr Reason reason() const noexcept {
        Reason reason = Reason::ok;
        for (std::size_t i = 0; i < value_.size(); ++i) {
            if (!known_[i]) {
                reason = Reason::waiting_for_full_scale;
            } else if (!(value_[i] >= plausible_[i].lowest && value_[i] <= plausible_[i].highest)) {
                return Reason::full_scale_implausible;
            }
        }
        return reason;
    }

    /// Of a channel; meaningful while `reason()` is ok.
    [[nodiscard]] constexpr double operator[](std::size_t channel) const noexcept { return value_[channel]; }

    /// How often a full scale was reported anew with another value.
    [[nodiscard]] constexpr std::uint64_t changed() const noexcept { return changed_; }

  private:
    Ranges plausible_;
    std::array<double, static_cast<std::size_t>(channels)> value_{};
    std::array<bool, static_cast<std::size_t>(channels)> known_{};
    std::uint64_t changed_ = 0;
};

} // namespace dfdyn::hal
