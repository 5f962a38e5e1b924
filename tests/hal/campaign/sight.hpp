// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/faults.hpp"

#include <deque>
#include <vector>

namespace dfdyn::tests {

/// Information in the frames of one joint about its position, compared with the truth. The judge takes from
/// it the time since the last correct reading. A receiver cannot know more about a position that the joint's
/// limits allow.
///
/// The readings form runs. A run begins after a silence, or at a jump of the error. If the error is that of
/// the last reading of an earlier long run, that run continues, unless the jump leads to the zero. After a
/// silence or a jump, correct readings end the time without a correct reading only after as long again, at
/// most 0.42 s. A single correct reading does not end it, because it contradicts the wrong one before it, and
/// either may be correct.
/// before it contradict each other, and either may be right.
class JointSight {
  public:
    struct Run {
        std::int64_t begin_ns = 0; ///< true time
        /// Time from the last correct reading to the start: the larger of true time and stamps. Includes the
        /// frames that are dropped after the clock was set back.
        std::int64_t blind_ns = 0;
        double error_rad = 0;     ///< error of the reading at the start
        double from_zero_rad = 0; ///< distance of that reading from the device's zero
        bool at_zero = false;     ///< the run jumps there, to within 1.5 periods of motion from its zero
        double velocity = 0;      ///< true velocity at the start
        int readings = 0;
    };

    /// A reading with the time since the last correct one (0: it is correct), and the time span of the four
    /// correct ones before it (0: no velocity known).
    struct Blind {
        std::int64_t time_ns, blind_ns, span_ns;
    };

    /// A value sent by the device.
    struct Shown {
        std::int64_t time_ns; ///< time of the SYNC that the frame answers, or else of the frame
        double position_rad, effort;
        bool right;      ///< the position is correct as sent
        std::size_t run; ///< index of its run
    };

    JointSight(const FaultSite& site, std::size_t joint);

    /// Returns a run by its number.
    [[nodiscard]] const Run& run(std::size_t number) const { return runs_[number]; }

    /// Returns true if the device's values reach `value` between `from_ns` and `to_ns`, in a reading or on
    /// the line between two close ones. Uses the readings for which `counts(shown)` is true.
    template <class Counts>
    [[nodiscard]] bool shows(double Shown::*what, double value, double tolerance, std::int64_t from_ns,
                             std::int64_t to_ns, Counts counts) const {
        constexpr std::int64_t apart_ns = bus_max_age + 2 * bus_track_jitter;
        const auto begin = std::ranges::lower_bound(shown_, from_ns - apart_ns, {}, &Shown::time_ns);
        for (auto one = begin; one != shown_.end() && one->time_ns <= to_ns; ++one) {
            for (auto next = one; next != shown_.end() && next->time_ns <= one->time_ns + apart_ns; ++next) {
                if (counts(*one) && counts(*next) &&
                    is_on_line(*one, *next, what, value, tolerance, from_ns, to_ns)) {
                    return true;
                }
            }
        }
        return false;
    }

    /// Returns the run at a time.
    [[nodiscard]] const Run& run_at(std::int64_t true_ns) const;

    /// Returns the reading with the longest time since a correct one, among those around `time_ns` that an
    /// interpolation may use.
    [[nodiscard]] Blind blind_at(std::int64_t time_ns) const;

  private:
    struct Reading {
        std::int64_t true_ns, stamp_ns; ///< time of arrival, and stamp
        std::int64_t time_ns;           ///< its stamp, converted to the true clock
        double shown_rad, error_rad;
        bool right;
    };
    static bool is_on_line(const Shown& one, const Shown& next, double Shown::*what, double value,
                           double tolerance, std::int64_t from_ns, std::int64_t to_ns);
    /// Returns true if the joint can have moved there from the reading before. Then it only passes its zero.
    [[nodiscard]] bool can_move_to(const Reading& reading, double step_rad) const;
    static bool is_right(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void show(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void examine(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void take(Run seen, const Reading& reading);
    void begin_run(Run seen, const Reading& reading);
    [[nodiscard]] std::int64_t span_ns() const;

    std::vector<Run> runs_{Run{}};
    std::vector<Blind> blind_; ///< ordered by time
    std::vector<Shown> shown_; ///< ordered by time
    Reading last_{}, last_established_{};
    std::deque<std::int64_t> known_ns_; ///< times of the last correct readings since the clock step
    std::int64_t sync_ns_ = 0;          ///< stamp of the last SYNC
    int right_ = 0;                     ///< consecutive correct readings
    bool set_back_ = false;             ///< the clock was set back since `last_established_`
    struct WrongRun {
        Run run;
        std::size_t number; ///< number of runs up to it
        double error_rad;   ///< error of its last reading
    };
    std::vector<WrongRun> wrong_; ///< long ones since `last_established_`
};

} // namespace dfdyn::tests
