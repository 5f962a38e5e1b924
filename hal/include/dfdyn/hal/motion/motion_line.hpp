// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/encoder_reading.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Motion limits of a joint. The defaults exceed those of any arm; a joint's own limits detect smaller
/// faults.
struct MotionLimits {
    double velocity = 10;               ///< rad/s
    double acceleration = 100;          ///< rad/s²
    double stop = 20;                   ///< rad/s²; deceleration from a motion to constant readings
    Encoder encoder = Encoder::unknown; ///< not a limit, but used with them
};

/// Straight line through a few readings: position and velocity of a joint.
struct MotionLine {
    std::int64_t begin_ns = 0; ///< stamps of the first and the last reading
    std::int64_t end_ns = 0;
    double end_rad = 0;  ///< position at `end_ns`
    double velocity = 0; ///< rad/s; valid while `span_s` is not 0
    double span_s = 0;   ///< from first to last reading; 0: too short for a velocity

    [[nodiscard]] constexpr double at(std::int64_t stamp_ns) const noexcept {
        return end_rad + velocity * seconds_between(end_ns, stamp_ns);
    }

    /// Returns the largest distance (rad) of the joint from this line, `dt_s` after its end or before its
    /// start. Covers the acceleration limit, the rounding to counts of `step_rad`, and delays of stamps up to
    /// `jitter_s`. Requires a velocity.
    [[nodiscard]] constexpr double error(double dt_s, double acceleration, double step_rad,
                                         double jitter_s) const noexcept {
        const double bend = dt_s * dt_s + dt_s * span_s + span_s * span_s / 6; // of the least-squares line
        const double fastest = magnitude(velocity) + acceleration * (dt_s + span_s);
        // rounding by half a count: error of a line through 4 or 5 readings at its end, at most 1.2 counts
        const double rounding = 1.2 * (1 + dt_s / span_s);
        const double lateness = fastest * jitter_s * (1 + 0.5 * dt_s / span_s);
        return 0.5 * acceleration * bend + rounding * step_rad + lateness;
    }
};

/// Keeps the first or the last five readings of a run, and fits a line by least squares. O(1).
class ReadingWindow {
  public:
    static constexpr int size = 5;

    /// Adds a reading while there is room: keeps the first ones.
    constexpr void add_first(const EncoderReading& reading) noexcept {
        if (count_ < size) {
            point_[static_cast<std::size_t>(count_)] = {reading.stamp_ns, reading.position_rad};
            ++count_;
        }
    }

    /// Replaces the oldest reading: keeps the last ones.
    constexpr void add_last(const EncoderReading& reading) noexcept {
        if (count_ == size) {
            std::copy(point_.begin() + 1, point_.end(), point_.begin());
            --count_;
        }
        add_first(reading);
    }

    /// Returns the line through all but the first `skip_first` and the last `skip_last` readings. If they
    /// span less than half of `period_ns`, it has no velocity. Without readings, it is an empty line.
    [[nodiscard]] constexpr MotionLine line(int skip_first, int skip_last,
                                            std::int64_t period_ns) const noexcept {
        const int from = skip_first;
        const int to = count_ - skip_last;
        MotionLine line;
        if (to <= from) {
            return line;
        }
        const Point& last = point_[static_cast<std::size_t>(to - 1)];
        line.begin_ns = point_[static_cast<std::size_t>(from)].stamp_ns;
        line.end_ns = last.stamp_ns;
        line.end_rad = last.position_rad;
        if (to - from >= 2 && 2 * (line.end_ns - line.begin_ns) >= period_ns) {
            fit(line, from, to);
        }
        return line;
    }

  private:
    struct Point {
        std::int64_t stamp_ns = 0;
        double position_rad = 0;
    };

    constexpr void fit(MotionLine& line, int from, int to) const noexcept {
        double time = 0;
        double position = 0;
        for (int i = from; i < to; ++i) {
            time += offset_s(i, line);
            position += offset_rad(i, line);
        }
        time /= to - from;
        position /= to - from;
        double squares = 0;
        double products = 0;
        for (int i = from; i < to; ++i) {
            const double t = offset_s(i, line) - time;
            squares += t * t;
            products += t * (offset_rad(i, line) - position);
        }
        line.span_s = seconds_between(line.begin_ns, line.end_ns);
        line.velocity = products / squares;
        line.end_rad += position - line.velocity * time;
    }
    [[nodiscard]] constexpr double offset_s(int i, const MotionLine& line) const noexcept {
        return seconds_between(line.end_ns, point_[static_cast<std::size_t>(i)].stamp_ns);
    }
    [[nodiscard]] constexpr double offset_rad(int i, const MotionLine& line) const noexcept {
        return point_[static_cast<std::size_t>(i)].position_rad - line.end_rad;
    }

    std::array<Point, size> point_{};
    int count_ = 0;
};

} // namespace dfdyn::hal
