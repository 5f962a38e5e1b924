// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/motion_run.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Follows the readings of a joint, whatever they are worth and even where their time is known to a period
/// only. Knows whether they have jumped away from the trusted ones, several times further than the joint can
/// have moved, and not back. Positions that go on from there are not the joint's, although its limits may
/// allow them after a while. O(1).
class AwayWatch {
  public:
    /// `max_age_ns`: how far apart consecutive readings may be.
    constexpr AwayWatch(const MotionTolerance& tolerance, std::int64_t max_age_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns) {}

    /// Takes the next reading. A jump much smaller than the one before does not take that back; after a
    /// larger one nobody knows.
    constexpr void take(const EncoderReading& reading) noexcept {
        const double apart_rad = seen_ ? reading.position_rad - seen_->position_rad : 0;
        const std::int64_t since_ns = seen_ ? reading.stamp_ns - seen_->stamp_ns : 0;
        const double reach = tolerance_.reach(
            seconds_between(0, std::max<std::int64_t>(since_ns, 0) + tolerance_.period_ns), reading.step_rad);
        const double most = small_share * magnitude(away_rad_);
        const bool far = magnitude(apart_rad) > reach;
        const bool recent = since_ns <= max_age_ns_;
        if (away_rad_ == 0) {
            const bool very_far = small_share * magnitude(apart_rad) > reach;
            away_rad_ = very_far && recent && from_trusted_ ? apart_rad : 0;
        } else if (far && magnitude(apart_rad) < most) {
            away_rad_ += apart_rad;
        } else if (far || (!recent && reach > most)) {
            away_rad_ = 0;
        }
        seen_ = reading;
        from_trusted_ = false;
    }

    /// Takes a reading that is trusted; `established`: for so long that a jump from it leads away.
    constexpr void trust(const EncoderReading& reading, bool established) noexcept {
        seen_ = reading;
        from_trusted_ = established;
        away_rad_ = 0;
    }

    /// The clock of the stamps was set.
    constexpr void forget() noexcept {
        seen_.reset();
        away_rad_ = 0;
    }

    /// Returns true for a reading that comes after a silence.
    [[nodiscard]] constexpr bool silent_until(std::int64_t stamp_ns) const noexcept {
        return seen_ && stamp_ns - seen_->stamp_ns > max_age_ns_;
    }

    /// Returns true while the readings are elsewhere.
    [[nodiscard]] constexpr bool away() const noexcept { return away_rad_ != 0; }

  private:
    static constexpr double small_share = 0.2;

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    std::optional<EncoderReading> seen_;
    bool from_trusted_ =
        false;            ///< that reading is trusted: an encoder that froze jumps when it is good again
    double away_rad_ = 0; ///< from the joint
};

} // namespace dfdyn::hal
