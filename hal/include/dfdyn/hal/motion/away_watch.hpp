// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

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
        const double reach = tolerance_.reach_untimed(since_ns, reading.step_rad);
        const double most = small_share * magnitude(away_rad_);
        const bool far = magnitude(apart_rad) > reach;
        const bool recent = since_ns <= max_age_ns_;
        moved_rad_ += apart_rad;
        if (away_rad_ == 0) {
            const bool very_far = small_share * magnitude(apart_rad) > reach;
            away_rad_ = very_far && recent && from_trusted_ ? apart_rad : 0;
            moved_rad_ = 0;
            left_ns_ = reading.stamp_ns - since_ns;
        } else if (far && magnitude(apart_rad) < most) {
            away_rad_ += apart_rad;
            moved_rad_ -= apart_rad;
        } else if (far || (!recent && reach > most) || is_back(reading)) {
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

    /// The device was heard, whatever it said.
    constexpr void hear(std::int64_t stamp_ns) noexcept { heard_ns_ = stamp_ns; }

    /// The clock of the stamps was set.
    constexpr void forget() noexcept {
        seen_.reset();
        heard_ns_.reset();
        away_rad_ = 0;
    }

    /// For how long the device was silent before this reading (s).
    [[nodiscard]] constexpr double silent_s(std::int64_t stamp_ns) const noexcept {
        return heard_ns_ ? seconds_between(*heard_ns_, stamp_ns) : 0;
    }

    /// Returns true while the readings are elsewhere.
    [[nodiscard]] constexpr bool away() const noexcept { return away_rad_ != 0; }

  private:
    /// Of the largest motion against a jump, and of a jump against the one before. A jump that is less than
    /// five times as far may be a velocity limit that is too low, or a reading that is late.
    static constexpr double small_share = 0.2;

    /// Returns true if the readings have come back without another jump, and sooner than the joint moves so
    /// far itself at half of its velocity limit: frames were lost after a flipped bit, or a device filters.
    [[nodiscard]] constexpr bool is_back(const EncoderReading& reading) const noexcept {
        const double way_rad = magnitude(away_rad_);
        const double reach = tolerance_.reach_untimed(reading.stamp_ns - left_ns_, reading.step_rad);
        return reach <= 2 * way_rad && magnitude(away_rad_ + moved_rad_) <= std::min(reach, 0.5 * way_rad);
    }

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    std::optional<EncoderReading> seen_;
    std::optional<std::int64_t> heard_ns_; ///< when the device sent anything
    bool from_trusted_ = false; ///< `seen_` is trusted: an encoder that froze jumps when it is good again
    double away_rad_ = 0;       ///< from the joint
    double moved_rad_ = 0;      ///< since the readings are away, without jumps
    std::int64_t left_ns_ = 0;  ///< the last reading before that
};

} // namespace dfdyn::hal
