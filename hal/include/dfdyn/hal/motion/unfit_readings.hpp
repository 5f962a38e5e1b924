// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Readings since the last trusted one that are of no use as positions: their time is known to a period only,
/// or the device was not ready. They still show what the encoder does. O(1).
class UnfitReadings {
  public:
    /// `max_age_ns`: how far apart consecutive readings may be; `jitter_ns`: largest lateness of a stamp.
    constexpr UnfitReadings(const MotionTolerance& tolerance, std::int64_t max_age_ns,
                            std::int64_t jitter_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns), jitter_ns_(jitter_ns) {}

    /// Takes a reading of a device that says that it is not ready.
    constexpr void take(const EncoderReading& reading) noexcept {
        if (!leads_to_next(reading)) {
            agree_ = false;
        }
        untimed_ = false;
        last_ = reading;
    }

    /// Takes a reading of unknown time.
    constexpr void take_untimed(const EncoderReading& reading) noexcept {
        moved_ = moved_ || (is_recent(reading, max_age_ns_ + 2 * jitter_ns_) &&
                            magnitude(reading.position_rad - last_->position_rad) > 2 * reading.step_rad);
        if (reading.zero || !leads_to_next(reading)) {
            agree_ = false;
        } else if (!agree_ && untimed_) {
            agree_ = true;
            first_ = {*last_, reading};
        }
        untimed_ = !reading.zero;
        last_ = reading;
    }

    /// Forgets them: the joint is trusted.
    constexpr void clear() noexcept {
        agree_ = untimed_ = false;
        last_.reset();
        moved_ = false;
    }

    /// Returns the last of them; `other` if there is none.
    [[nodiscard]] constexpr const EncoderReading& last_or(const EncoderReading& other) const noexcept {
        return last_ ? *last_ : other;
    }

    /// Returns whether those of unknown time differed from each other.
    [[nodiscard]] constexpr bool moved() const noexcept { return moved_; }

    /// Returns whether no motion leads to this reading from the last of them, shortly before.
    [[nodiscard]] constexpr bool contradict(const EncoderReading& reading) const noexcept {
        return is_recent(reading, max_age_ns_ + 2 * jitter_ns_) && is_far(*last_, reading);
    }

    /// Returns whether the joint can have moved to this reading from the last of them, in a short silence.
    [[nodiscard]] constexpr bool lead_to(const EncoderReading& reading) const noexcept {
        return is_recent(reading, 3 * max_age_ns_) && !is_far(*last_, reading);
    }

    /// Returns whether they lead to this reading, one to the next, from two of unknown time to which the
    /// joint cannot have moved. A single one may have a flipped bit, and a zero or a device that is not ready
    /// shows no place.
    [[nodiscard]] constexpr bool lead_from_afar(const EncoderReading& trusted,
                                                const EncoderReading& reading) const noexcept {
        return agree_ && leads_to_next(reading) && std::ranges::all_of(first_, [&](const auto& first) {
                   return magnitude(first.position_rad - trusted.position_rad) >
                          tolerance_.reach_untimed(first.stamp_ns - trusted.stamp_ns, reading.step_rad);
               });
    }

    /// Returns whether a joint cannot move from one reading to the other, whose time is known to a period.
    [[nodiscard]] constexpr bool is_far(const EncoderReading& from, const EncoderReading& to) const noexcept {
        const std::int64_t since_ns = std::min(to.stamp_ns - from.stamp_ns, max_age_ns_);
        return magnitude(to.position_rad - from.position_rad) >
               tolerance_.reach_untimed(since_ns, to.step_rad);
    }

  private:
    [[nodiscard]] constexpr bool leads_to_next(const EncoderReading& reading) const noexcept {
        return is_recent(reading, max_age_ns_ + 2 * jitter_ns_) && !is_far(*last_, reading);
    }

    [[nodiscard]] constexpr bool is_recent(const EncoderReading& reading,
                                           std::int64_t most_ns) const noexcept {
        return last_ && reading.stamp_ns - last_->stamp_ns <= most_ns;
    }

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    std::int64_t jitter_ns_;
    std::array<EncoderReading, 2>
        first_{};        ///< where they agree: of those that lead to the last, one to the next
    bool agree_ = false; ///< two of unknown time in a row, and all since
    std::optional<EncoderReading> last_;
    bool untimed_ = false; ///< the last one, and it is no zero
    bool moved_ = false;   ///< those of unknown time
};

} // namespace dfdyn::hal
