// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Readings since the last trusted one that give no position: their time is known only to within one period,
/// or the device was not ready. They still show the motion of the encoder. O(1).
class UnfitReadings {
  public:
    /// `max_age_ns`: largest interval between consecutive readings; `jitter_ns`: largest delay of a stamp.
    constexpr UnfitReadings(const MotionTolerance& tolerance, std::int64_t max_age_ns,
                            std::int64_t jitter_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns), jitter_ns_(jitter_ns) {}

    /// Takes a reading that the device marked as not ready.
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

    /// Forgets them, because the joint is trusted.
    constexpr void clear() noexcept {
        agree_ = untimed_ = false;
        last_.reset();
        moved_ = false;
    }

    /// Returns the last one; `other` if there is none.
    [[nodiscard]] constexpr const EncoderReading& last_or(const EncoderReading& other) const noexcept {
        return last_ ? *last_ : other;
    }

    /// Returns true if the readings of unknown time differed from each other.
    [[nodiscard]] constexpr bool moved() const noexcept { return moved_; }

    /// Returns true if no motion leads from the last one, shortly before, to this reading.
    [[nodiscard]] constexpr bool contradict(const EncoderReading& reading) const noexcept {
        return is_recent(reading, max_age_ns_ + 2 * jitter_ns_) && is_far(*last_, reading);
    }

    /// Returns true if the joint can have moved from the last one to this reading, after a short silence.
    [[nodiscard]] constexpr bool lead_to(const EncoderReading& reading) const noexcept {
        return is_recent(reading, 3 * max_age_ns_) && !is_far(*last_, reading);
    }

    /// Returns true if they lead consistently to this reading, from two readings of unknown time that the
    /// joint cannot have reached. One reading may have a flipped bit. A zero, or a device that is not ready,
    /// gives no position.
    [[nodiscard]] constexpr bool lead_from_afar(const EncoderReading& trusted,
                                                const EncoderReading& reading) const noexcept {
        return agree_ && leads_to_next(reading) && std::ranges::all_of(first_, [&](const auto& first) {
                   return magnitude(first.position_rad - trusted.position_rad) >
                          tolerance_.reach_untimed(first.stamp_ns - trusted.stamp_ns, reading.step_rad);
               });
    }

    /// Returns true if a joint cannot have moved between two readings that are stamped to within a period.
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
    std::array<EncoderReading, 2> first_{}; ///< the first two consistent ones, while `agree_`
    bool agree_ = false; ///< two consecutive readings of unknown time, and all since, are consistent
    std::optional<EncoderReading> last_;
    bool untimed_ = false; ///< the last one has an unknown time and is not zero
    bool moved_ = false;   ///< those of unknown time differed
};

} // namespace dfdyn::hal
