// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Detects that an encoder has jumped at least five times further than the joint can move, and has not jumped
/// back. Later positions along that motion are not the joint's, even if its limits allow them after a while.
/// Uses all readings, including those whose time is known only to within one period. O(1).
class AwayWatch {
  public:
    /// `max_age_ns`: largest interval between consecutive readings.
    constexpr AwayWatch(const MotionTolerance& tolerance, std::int64_t max_age_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns) {}

    /// Takes the next reading. A further jump below a fifth of the offset changes the offset. A larger jump
    /// ends the detection, because the readings are then ambiguous.
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

    /// Takes a trusted reading. `established`: trusted for long enough that a jump from it counts as a jump
    /// away.
    constexpr void trust(const EncoderReading& reading, bool established) noexcept {
        seen_ = reading;
        from_trusted_ = established;
        away_rad_ = 0;
    }

    /// Notes that the device sent a frame, valid or not.
    constexpr void hear(std::int64_t stamp_ns) noexcept { heard_ns_ = stamp_ns; }

    /// Forgets all stamps, because their clock was set.
    constexpr void forget() noexcept {
        seen_.reset();
        heard_ns_.reset();
        away_rad_ = 0;
    }

    /// Returns how long the device was silent before this reading (s).
    [[nodiscard]] constexpr double silent_s(std::int64_t stamp_ns) const noexcept {
        return heard_ns_ ? seconds_between(*heard_ns_, stamp_ns) : 0;
    }

    /// Returns true while the readings are away from the joint.
    [[nodiscard]] constexpr bool away() const noexcept { return away_rad_ != 0; }

  private:
    /// Largest ratio of the possible motion to the jump, and of a later jump to the offset. A smaller jump
    /// may come from a velocity limit that is too low, or from a late reading.
    static constexpr double small_share = 0.2;

    /// Returns true if the readings have returned without a jump, earlier than the joint could at half of its
    /// velocity limit. Causes: frames lost after a flipped bit, or a device that filters.
    [[nodiscard]] constexpr bool is_back(const EncoderReading& reading) const noexcept {
        const double way_rad = magnitude(away_rad_);
        const double reach = tolerance_.reach_untimed(reading.stamp_ns - left_ns_, reading.step_rad);
        return reach <= 2 * way_rad && magnitude(away_rad_ + moved_rad_) <= std::min(reach, 0.5 * way_rad);
    }

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    std::optional<EncoderReading> seen_;
    std::optional<std::int64_t> heard_ns_; ///< time at which the device last sent a frame
    bool from_trusted_ = false;            ///< `seen_` is trusted; false after a frozen encoder recovered
    double away_rad_ = 0;                  ///< offset of the readings from the joint; 0: not away
    double moved_rad_ = 0;                 ///< motion since the jump, without further jumps
    std::int64_t left_ns_ = 0;             ///< stamp of the last reading before the jump
};

} // namespace dfdyn::hal
