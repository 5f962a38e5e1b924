// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_line.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Tolerances for the comparison of a joint's readings.
struct MotionTolerance {
    MotionLimits limits;
    std::int64_t period_ns = 0; ///< of the readings; 0: unknown
    double jitter_s = 0;        ///< largest delay of a stamp relative to another one

    /// Returns the largest distance (rad) between two positions measured `dt_s` apart.
    [[nodiscard]] constexpr double reach(double dt_s, double step_rad) const noexcept {
        return limits.velocity * (dt_s + jitter_s) + 2 * step_rad;
    }

    /// Returns the largest distance (rad) between two readings `since_ns` apart, each stamped to within a
    /// period.
    [[nodiscard]] constexpr double reach_untimed(std::int64_t since_ns, double step_rad) const noexcept {
        return reach(seconds_between(0, std::max<std::int64_t>(since_ns, 0) + period_ns), step_rad);
    }

    [[nodiscard]] constexpr bool reaches(const EncoderReading& from,
                                         const EncoderReading& to) const noexcept {
        const double distance = magnitude(to.position_rad - from.position_rad);
        return distance <= reach(seconds_between(from.stamp_ns, to.stamp_ns), to.step_rad);
    }

    /// Returns the largest distance (rad) of a reading from the line through those before it.
    [[nodiscard]] constexpr double error(const MotionLine& line, double dt_s,
                                         double step_rad) const noexcept {
        return line.error(dt_s, limits.acceleration, step_rad, jitter_s);
    }

    /// Returns true if a joint that moved along this line cannot have stopped within `dt_s`, so that it
    /// cannot repeat a reading.
    [[nodiscard]] constexpr bool must_move(const MotionLine& line, double dt_s,
                                           double step_rad) const noexcept {
        if (line.span_s <= 0) {
            return false;
        }
        const double braking = 0.5 * limits.stop * dt_s * (dt_s + line.span_s);
        return magnitude(line.velocity) * (dt_s - 2 * jitter_s) > braking + 4 * step_rad;
    }
};

/// Consistent readings of one joint. Each call costs O(1). Keeps at most ten readings.
class MotionRun {
  public:
    static constexpr double unlimited_s = 1e9;

    /// Adds the next reading. Stamps must increase.
    constexpr void extend(const EncoderReading& reading, const MotionTolerance& tolerance) noexcept {
        const bool moved = count_ == 0 || reading.position_rad != last_.position_rad;
        const bool further = count_ == 0 || reading.position_rad > highest_ || reading.position_rad < lowest_;
        highest_ = count_ == 0 ? reading.position_rad : std::max(highest_, reading.position_rad);
        lowest_ = count_ == 0 ? reading.position_rad : std::min(lowest_, reading.position_rad);
        advances_ = std::min(advances_ + (further ? 1 : 0), enough_advances);
        first_ = count_ == 0 ? reading : first_;
        const double passed_s = count_ == 0 ? 0 : seconds_between(last_.stamp_ns, reading.stamp_ns);
        last_ = reading;
        first_readings_.add_first(reading);
        last_readings_.add_last(reading);
        earlier_ = line_;
        line_ = last_readings_.line(count_ >= ReadingWindow::size - 1 ? 1 : 0, 0, tolerance.period_ns);
        speed_ = std::max(line_.span_s > 0 ? magnitude(line_.velocity) : 0,
                          speed_ - tolerance.limits.stop * passed_s);
        if (moved) {
            moving_ = line_;
            moved_ns_ = reading.stamp_ns;
        }
        changes_ = std::min(changes_ + (moved && count_ > 0 ? 1 : 0), max_count);
        count_ = std::min(count_ + 1, max_count);
        zeros_ = reading.zero ? std::min(zeros_ + 1, max_count) : 0;
        readings_ = std::min(readings_ + (reading.zero ? 0 : 1), max_count);
    }

    /// Adds a reading after a silence, during which the motion may have changed.
    constexpr void resume(const EncoderReading& reading, const MotionTolerance& tolerance) noexcept {
        last_readings_ = {};
        line_ = {};
        extend(reading, tolerance);
    }

    /// Returns true if the joint can have this reading next. It must fit the line through the last readings,
    /// and also the line without the last one, which may be off by the full tolerance. After `longest_s`
    /// without readings the tolerance no longer grows.
    [[nodiscard]] constexpr bool leads_to(const EncoderReading& to, const MotionTolerance& tolerance,
                                          double longest_s = unlimited_s) const noexcept {
        if (!tolerance.reaches(last_, to) || repeats(to, tolerance)) {
            return false;
        }
        return is_near(line_, to, tolerance, longest_s) &&
               is_near(earlier_, to, tolerance, longest_s + seconds_between(earlier_.end_ns, line_.end_ns));
    }

    /// Returns true if a reading repeats the last one exactly although the joint must have moved.
    [[nodiscard]] constexpr bool repeats(const EncoderReading& to,
                                         const MotionTolerance& tolerance) const noexcept {
        const double dt_s = seconds_between(moved_ns_, to.stamp_ns);
        return count_ > 0 && to.position_rad == last_.position_rad &&
               tolerance.must_move(moving_, dt_s, to.step_rad);
    }

    /// Returns true if the joint cannot have stopped since its highest velocity.
    [[nodiscard]] constexpr bool moves(const MotionTolerance& tolerance) const noexcept {
        MotionLine fastest = moving_;
        fastest.velocity = speed_;
        return tolerance.must_move(fastest, fastest.span_s, last_.step_rad);
    }

    /// Returns the line through its first or last readings, without the outermost `skip`.
    [[nodiscard]] constexpr MotionLine begin_line(int skip, std::int64_t period_ns) const noexcept {
        return first_readings_.line(skip, 0, period_ns);
    }
    [[nodiscard]] constexpr MotionLine end_line(int skip, std::int64_t period_ns) const noexcept {
        return last_readings_.line(0, skip, period_ns);
    }

    [[nodiscard]] constexpr bool empty() const noexcept { return count_ == 0; }
    [[nodiscard]] constexpr const EncoderReading& first() const noexcept { return first_; }
    [[nodiscard]] constexpr const EncoderReading& last() const noexcept { return last_; }

    /// Returns true if the run shows no motion yet: fewer than ten readings beyond all before them, and fewer
    /// than half that differ from the one before. A few flipped bits are no motion.
    [[nodiscard]] constexpr bool still() const noexcept {
        const bool changes = changes_ >= enough_changes && 2 * changes_ >= count_;
        return advances_ < enough_advances && !changes;
    }

    /// Return the number of readings other than zero, and of zeros at the end; at most a million.
    [[nodiscard]] constexpr int readings() const noexcept { return readings_; }
    [[nodiscard]] constexpr int zeros() const noexcept { return zeros_; }

  private:
    static constexpr int max_count = 1'000'000;
    static constexpr int enough_advances = 10;
    static constexpr int enough_changes = 5;

    [[nodiscard]] static constexpr bool is_near(const MotionLine& line, const EncoderReading& to,
                                                const MotionTolerance& tolerance, double longest_s) noexcept {
        const double dt_s = seconds_between(line.end_ns, to.stamp_ns);
        return line.span_s <= 0 || magnitude(to.position_rad - line.at(to.stamp_ns)) <=
                                       tolerance.error(line, std::min(dt_s, longest_s), to.step_rad);
    }

    EncoderReading first_;
    EncoderReading last_;
    ReadingWindow first_readings_;
    ReadingWindow last_readings_;
    MotionLine line_;    ///< through the last four readings
    MotionLine earlier_; ///< `line_` at the reading before; delays of consecutive stamps add up in `line_`
    MotionLine moving_;  ///< `line_` at the last reading that differed from the one before
    std::int64_t moved_ns_ = 0; ///< stamp of that reading
    double speed_ = 0;          ///< highest velocity, reduced by the deceleration limit
    int count_ = 0;
    int readings_ = 0;
    int zeros_ = 0;
    int changes_ = 0;  ///< readings that differ from the one before
    int advances_ = 0; ///< readings beyond all before them
    double highest_ = 0;
    double lowest_ = 0;
};

} // namespace dfdyn::hal
