// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <cstdint>
#include <span>

namespace dfdyn::hal {

/// Detects readings that are wrong because the sensor is at the end of its range: the device reports it, or a
/// raw value is at an end of 16 bits. Some devices leave this test to the receiver.
class SaturationGate {
  public:
    /// Takes a reading and returns true if it is saturated. `flagged`: the device reports saturation.
    constexpr bool saturated(bool flagged, std::span<const std::int32_t> raw) noexcept {
        bool now = flagged;
        for (const std::int32_t value : raw) {
            now = now || value >= rail || value <= -rail;
        }
        readings_ += now ? 1U : 0U;
        episodes_ += now && !before_ ? 1U : 0U;
        before_ = now;
        return now;
    }

    /// Return the number of saturated readings, and of runs of them.
    [[nodiscard]] constexpr std::uint64_t count() const noexcept { return readings_; }
    [[nodiscard]] constexpr std::uint64_t episodes() const noexcept { return episodes_; }

  private:
    static constexpr std::int32_t rail = 32767;

    bool before_ = false;
    std::uint64_t readings_ = 0;
    std::uint64_t episodes_ = 0;
};

} // namespace dfdyn::hal
