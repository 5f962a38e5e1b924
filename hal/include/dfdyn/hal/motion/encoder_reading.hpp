// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/gate/range.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// What an encoder shows after it was switched on, or restarted.
enum class Encoder : std::uint8_t {
    unknown,     ///< one of the others
    absolute,    ///< the joint's position
    incremental, ///< its own zero, wherever the joint is
};

/// One reading of a joint's encoder.
struct EncoderReading {
    std::int64_t stamp_ns = 0;
    double position_rad = 0;
    double step_rad = 0;      ///< one encoder count
    double wrap_rad = 0;      ///< range of the device's integer, after which it wraps; 0: does not wrap
    double from_zero_rad = 0; ///< distance from the position at which the device's own number is 0
    bool zero = false; ///< the device's number is exactly 0, which may mean that it has no position yet
};

/// Returns a time in seconds.
[[nodiscard]] constexpr double seconds_of(std::int64_t time_ns) noexcept {
    return 1e-9 * static_cast<double>(time_ns);
}

/// Returns the time from one stamp to another (s).
[[nodiscard]] constexpr double seconds_between(std::int64_t from_ns, std::int64_t to_ns) noexcept {
    return seconds_of(to_ns - from_ns);
}

/// Moves a reading of a wrapping integer to the turn nearest to `about_rad`. Does not change a reading that
/// is not finite, or that of a device that does not wrap. O(1).
constexpr void unwrap_near(EncoderReading& reading, double about_rad) noexcept {
    const double turn = reading.wrap_rad;
    constexpr double max_turns = 1e15; // beyond it a double does not resolve a turn
    if (turn > 0 && magnitude(reading.position_rad) < max_turns * turn) {
        const double turns = (about_rad - reading.position_rad) / turn;
        reading.position_rad +=
            turn * static_cast<double>(static_cast<std::int64_t>(turns + (turns < 0 ? -0.5 : 0.5)));
    }
}

/// Moves a reading of a wrapping integer to the turn nearest to the middle of the joint's range. Returns true
/// if no other turn lies within the range. O(1).
constexpr bool unwrap_within(EncoderReading& reading, const Range& range) noexcept {
    unwrap_near(reading, 0.5 * (range.highest + range.lowest));
    return reading.position_rad - reading.wrap_rad < range.lowest &&
           reading.position_rad + reading.wrap_rad > range.highest;
}

/// Returns true if the joint's range is narrower than one turn of its encoder's integer.
[[nodiscard]] constexpr bool has_one_turn(const Range& range, double wrap_rad) noexcept {
    return range.highest - range.lowest < wrap_rad;
}

} // namespace dfdyn::hal
