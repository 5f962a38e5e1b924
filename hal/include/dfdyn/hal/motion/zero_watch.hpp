// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Detects an encoder that counts from where it was switched on: its readings begin at its own zero. Tracks
/// the run that continues the last reading near the zero that the joint's motion does not explain. Uses all
/// readings, including those that give no position. O(1).
class ZeroWatch {
  public:
    /// `max_age_ns`: largest interval between consecutive readings.
    constexpr ZeroWatch(const MotionTolerance& tolerance, std::int64_t max_age_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns) {}

    /// Forgets the tracked run, because a reading was trusted.
    constexpr void forget() noexcept { counted_ = {}; }

    /// Takes an untrusted reading. `expected`: a motion seen shortly before may lead to it.
    constexpr void take(const EncoderReading& reading, bool expected) noexcept {
        const bool recent = !counted_.empty() && reading.stamp_ns - counted_.last().stamp_ns <= max_age_ns_;
        const bool repeats = reading.position_rad == counted_.first().position_rad;
        const bool waits = recent && repeats && counted_.still(); // the device is not ready yet
        const bool leads = recent && !waits && counted_.leads_to(reading, tolerance_);
        if (!leads && !waits && (!is_near_zero(reading) || expected || follows_better(reading))) {
            return;
        }
        counted_ = leads ? counted_ : MotionRun();
        counted_.extend(reading, tolerance_);
    }

    /// Returns true if a run begins within a few periods of motion from the zero, or continues readings that
    /// began there. `trusted_velocity`: velocity of the joint when it was last trusted; `hidden_s`: time
    /// before the run without known readings.
    [[nodiscard]] constexpr bool explains(const EncoderReading& first, const MotionLine& begin,
                                          double trusted_velocity, double hidden_s) const noexcept {
        if (tolerance_.limits.encoder == Encoder::absolute) {
            return false;
        }
        if (magnitude(first.from_zero_rad) <= travel(first, begin, trusted_velocity, hidden_s) &&
            leaves_zero(first, begin, hidden_s)) {
            return true;
        }
        const bool counts =
            !counted_.empty() && magnitude(counted_.first().from_zero_rad) <=
                                     travel(counted_.first(), begin, trusted_velocity, hidden_s);
        if (!counts || !(counted_leaves_zero(0, hidden_s) || counted_leaves_zero(1, hidden_s))) {
            return false;
        }
        return goes_on(first, begin, trusted_velocity);
    }

    /// Returns true if an incremental encoder that restarted between two runs can have counted to the second
    /// one at the faster of their velocities. `clock_s`: additional time, if the clock was set.
    [[nodiscard]] constexpr bool may_explain(const MotionRun& before, const MotionRun& run,
                                             double clock_s) const noexcept {
        if (tolerance_.limits.encoder != Encoder::incremental || before.empty()) {
            return false;
        }
        const double silence_s = seconds_between(before.last().stamp_ns, run.first().stamp_ns);
        const double most =
            travel(run.first(), run.begin_line(0, tolerance_.period_ns),
                   before.end_line(0, tolerance_.period_ns).velocity, std::max(0.0, silence_s) + clock_s);
        return magnitude(run.first().from_zero_rad) <= most;
    }

    /// Returns true if the joint can have moved to this reading, stamped to within a period, from readings
    /// that began at the zero.
    [[nodiscard]] constexpr bool lead_to_untimed(const EncoderReading& reading) const noexcept {
        const std::int64_t since_ns = reading.stamp_ns - counted_.last().stamp_ns;
        const double apart = magnitude(reading.from_zero_rad - counted_.last().from_zero_rad); // any turn
        return tolerance_.limits.encoder != Encoder::absolute && counted_.readings() > 0 && since_ns >= 0 &&
               since_ns <= max_age_ns_ + 2 * tolerance_.period_ns &&
               apart <= tolerance_.reach_untimed(since_ns, reading.step_rad);
    }

    /// Returns the readings that continue one at the zero.
    [[nodiscard]] constexpr const MotionRun& counted() const noexcept { return counted_; }

  private:
    static constexpr int min_counted_readings = 5; ///< of an encoder that counts from its zero

    /// Returns true if a run continues the readings that began at the zero: it is part of them, or its line
    /// leads back to the first or the last of them.
    [[nodiscard]] constexpr bool goes_on(const EncoderReading& first, const MotionLine& begin,
                                         double trusted_velocity) const noexcept {
        const bool within = first.stamp_ns >= counted_.first().stamp_ns &&
                            first.stamp_ns <= counted_.last().stamp_ns &&
                            counted_.readings() >= min_counted_readings;
        const bool moved = counted_.readings() > 1; // a single wrong reading may have joined the zero
        return within || leads_back(first, begin, trusted_velocity, counted_.first()) ||
               (moved && leads_back(first, begin, trusted_velocity, counted_.last()));
    }
    [[nodiscard]] constexpr bool leads_back(const EncoderReading& first, const MotionLine& begin,
                                            double trusted_velocity,
                                            const EncoderReading& to) const noexcept {
        const double since_s = seconds_between(to.stamp_ns, first.stamp_ns);
        if (since_s <= 0 || since_s > memory_s) { // negative: the clock was set
            return false;
        }
        const double off = magnitude(first.from_zero_rad - to.from_zero_rad);
        const double back_rad = first.from_zero_rad - begin.velocity * since_s - to.from_zero_rad;
        return off <= travel(first, begin, trusted_velocity, since_s) &&
               (begin.span_s <= 0 || magnitude(back_rad) <= tolerance_.error(begin, since_s, first.step_rad));
    }

    /// Returns true if a run may have been at the zero shortly before. An encoder that counts from the zero
    /// moves away from it. A joint that crosses its zero was on the other side before.
    [[nodiscard]] constexpr bool leaves_zero(const EncoderReading& first, const MotionLine& begin,
                                             double hidden_s) const noexcept {
        const double before_s = hidden_s + periods * seconds_between(0, tolerance_.period_ns);
        const double before_rad = first.from_zero_rad - begin.velocity * before_s;
        const double nearest_rad = std::min(magnitude(first.from_zero_rad), magnitude(before_rad));
        return begin.span_s <= 0 || first.from_zero_rad * before_rad <= 0 ||
               nearest_rad <= tolerance_.error(begin, before_s, first.step_rad);
    }

    [[nodiscard]] constexpr bool counted_leaves_zero(int skip, double hidden_s) const noexcept {
        return leaves_zero(counted_.first(), counted_.begin_line(skip, tolerance_.period_ns), hidden_s);
    }

    /// Returns true if the tracked readings began closer to the zero than this one.
    [[nodiscard]] constexpr bool follows_better(const EncoderReading& reading) const noexcept {
        if (counted_.empty()) {
            return false;
        }
        const double since_s = seconds_between(counted_.last().stamp_ns, reading.stamp_ns);
        const bool closer = magnitude(counted_.first().from_zero_rad) < magnitude(reading.from_zero_rad);
        return since_s >= 0 && since_s <= memory_s && (closer || counted_.readings() >= min_counted_readings);
    }

    /// Returns the distance (rad) from the zero after `since_s` and the time until the first reading.
    [[nodiscard]] constexpr double travel(const EncoderReading& first, const MotionLine& begin,
                                          double trusted_velocity, double since_s) const noexcept {
        const double fastest =
            std::max(magnitude(begin.velocity), since_s > 0 ? magnitude(trusted_velocity) : 0);
        return fastest * (since_s + periods * seconds_between(0, tolerance_.period_ns)) + 3 * first.step_rad;
    }

    [[nodiscard]] constexpr bool is_near_zero(const EncoderReading& reading) const noexcept {
        const double moved = tolerance_.limits.velocity * seconds_between(0, tolerance_.period_ns);
        return magnitude(reading.from_zero_rad) <= moved + 3 * reading.step_rad;
    }

    static constexpr double periods = 1.5;   ///< between the zero and the first reading after it
    static constexpr double memory_s = 0.05; // longest time from the zero to the first positions

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    MotionRun counted_; ///< tracked run
};

} // namespace dfdyn::hal
