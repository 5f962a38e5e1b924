// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_run.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Decides if the motion of a joint can lead from one run of readings to another. O(1).
class RunComparison {
  public:
    /// `max_age_ns`: largest interval between consecutive readings; `jitter_ns`: largest delay of a stamp.
    constexpr RunComparison(const MotionTolerance& tolerance, std::int64_t max_age_ns,
                            std::int64_t jitter_ns) noexcept
        : tolerance_(tolerance), max_age_ns_(max_age_ns), jitter_ns_(jitter_ns) {}

    /// Returns true if two readings are consecutive, with at most a few lost ones between them.
    [[nodiscard]] constexpr bool near(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
        return to_ns - from_ns <= max_age_ns_ + 2 * jitter_ns_;
    }

    /// Returns true if the reading is the next one of the run.
    [[nodiscard]] constexpr bool continues(const MotionRun& run, const EncoderReading& to) const noexcept {
        return !run.empty() && near(run.last().stamp_ns, to.stamp_ns) && run.leads_to(to, tolerance_);
    }

    /// Returns true if the acceleration limit allows the reading after a silence that follows the run.
    [[nodiscard]] constexpr bool reaches_after_silence(const MotionRun& before,
                                                       const EncoderReading& to) const noexcept {
        constexpr double share_of_limits = 0.8; // no joint accelerates at its limit for so long
        bool reached = false;
        for (const int skip : {0, 1}) {
            const MotionLine line = before.end_line(skip, tolerance_.period_ns);
            const double dt_s = seconds_between(line.end_ns, to.stamp_ns);
            const double off = magnitude(to.position_rad - line.at(to.stamp_ns));
            reached = reached || line.span_s <= 0 ||
                      off <= share_of_limits * tolerance_.error(line, dt_s, to.step_rad);
        }
        return reached;
    }

    /// Returns true if the acceleration limit allows a run after a silence that follows another run. From
    /// velocity v0 to v1 within T, a joint moves (v0 + v1) T / 2, with an error of at most a T² / 4.
    [[nodiscard]] constexpr bool can_follow(const MotionRun& before, const MotionRun& run) const noexcept {
        bool can = false;
        for (const int skip : {0, 1}) {
            const MotionLine from = before.end_line(skip, tolerance_.period_ns);
            const MotionLine to = run.begin_line(skip, tolerance_.period_ns);
            can = can || from.span_s <= 0 || to.span_s <= 0 || can_follow(from, to, run.first());
        }
        return can;
    }

    /// Returns true if the motion of the run leads to this reading within at most `most_s`.
    [[nodiscard]] constexpr bool comes_within(const MotionRun& before, const EncoderReading& to,
                                              double most_s) const noexcept {
        const MotionLine line = before.end_line(0, tolerance_.period_ns);
        const double way = line.velocity * most_s;
        const double off = to.position_rad - line.end_rad;
        const double error = tolerance_.error(line, most_s, to.step_rad);
        return line.span_s > 0 && off >= std::min(way, 0.0) - error && off <= std::max(way, 0.0) + error;
    }

    /// Returns true if a reading continues the run as if no time had passed. A clock that is set forward
    /// looks like a silence.
    [[nodiscard]] constexpr bool goes_on_without_silence(const MotionRun& before,
                                                         const EncoderReading& to) const noexcept {
        const MotionLine line = before.end_line(0, tolerance_.period_ns);
        const double period_s = seconds_between(0, tolerance_.period_ns);
        const double off = to.position_rad - line.end_rad - line.velocity * period_s;
        return line.span_s > 0 && magnitude(off) <= tolerance_.error(line, 2 * period_s, to.step_rad);
    }

    /// Returns true if a run reverses most of the jump from `before` to `elsewhere`. A velocity from more
    /// than `longest_ns` before the jump is not extrapolated. Between the jumps the joint moved as
    /// `elsewhere` or as `run`.
    [[nodiscard]] constexpr bool takes_back(const MotionRun& before, const MotionRun& elsewhere,
                                            const MotionRun& run, std::int64_t longest_ns) const noexcept {
        constexpr double most_left = 0.5;
        const MotionLine from = before.end_line(0, tolerance_.period_ns);
        const MotionLine left = elsewhere.end_line(0, tolerance_.period_ns);
        const MotionLine back = run.begin_line(0, tolerance_.period_ns);
        const EncoderReading& away = elsewhere.first();
        const double expected_rad =
            away.stamp_ns - from.end_ns > longest_ns ? from.end_rad : from.at(away.stamp_ns);
        const double off_rad = away.position_rad - expected_rad;
        const double as_elsewhere_rad = run.first().position_rad - left.at(run.first().stamp_ns) + off_rad;
        const double as_run_rad = back.at(away.stamp_ns) - expected_rad;
        return std::min(magnitude(as_elsewhere_rad), magnitude(as_run_rad)) <= most_left * magnitude(off_rad);
    }

    /// Returns true if the motions before and after a jump meet between them. Either may have one wrong
    /// reading. After `longest_s` between them the tolerance no longer grows. `share(line)`: fraction of the
    /// tolerance for a run that begins with this line.
    template <class Share>
    [[nodiscard]] constexpr bool meets(const MotionRun& before, const MotionRun& run, double longest_s,
                                       Share share) const noexcept {
        const std::int64_t period_ns = tolerance_.period_ns;
        const MotionLine from = before.end_line(0, period_ns);
        const MotionLine to = run.begin_line(0, period_ns);
        return meets(before.end_line(1, period_ns), to, run.first(), longest_s, share) ||
               meets(from, run.begin_line(1, period_ns), run.first(), longest_s, share) ||
               meets(from, to, run.first(), longest_s, share);
    }

    /// Returns true if two lines meet between them; `first` is the first reading of the second line.
    template <class Share>
    [[nodiscard]] constexpr bool meets(const MotionLine& from, const MotionLine& to,
                                       const EncoderReading& first, double longest_s,
                                       Share share) const noexcept {
        if (from.span_s <= 0 || to.span_s <= 0) {
            return false;
        }
        const double dt_s = std::min(seconds_between(from.end_ns, to.begin_ns), longest_s);
        const double before = to.at(from.end_ns) - from.end_rad;
        const double after = to.at(to.begin_ns) - from.at(to.begin_ns);
        const double limit =
            0.5 * (tolerance_.error(from, dt_s, first.step_rad) + tolerance_.error(to, dt_s, first.step_rad));
        const double fastest =
            magnitude(from.velocity) + tolerance_.limits.acceleration * (dt_s + from.span_s + to.span_s);
        if (magnitude(to.velocity) > fastest) { // an impact reduces or reverses the velocity
            return false;
        }
        const double nearest = std::min(magnitude(before), magnitude(after));
        return before * after <= 0 || nearest <= share(to) * limit;
    }

  private:
    /// Returns true if a joint can move from the end of one line to the start of the other.
    [[nodiscard]] constexpr bool can_follow(const MotionLine& from, const MotionLine& to,
                                            const EncoderReading& first) const noexcept {
        const double dt_s = seconds_between(from.end_ns, to.begin_ns);
        const double half_acceleration = 0.5 * tolerance_.limits.acceleration;
        const auto error = [&](const MotionLine& line) {
            return line.error(dt_s, half_acceleration, first.step_rad, tolerance_.jitter_s);
        };
        const double fastest = std::max(magnitude(from.velocity), magnitude(to.velocity));
        const double ends = 2 * first.step_rad + fastest * tolerance_.jitter_s;
        const double before = to.at(from.end_ns) - from.end_rad;
        const double after = to.at(to.begin_ns) - from.at(to.begin_ns);
        return magnitude(before + after) <= error(from) + error(to) + 2 * ends;
    }

    MotionTolerance tolerance_;
    std::int64_t max_age_ns_;
    std::int64_t jitter_ns_;
};

} // namespace dfdyn::hal
