// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/faults.hpp"

#include <deque>
#include <vector>

namespace dfdyn::tests {

/// What the frames of one joint show of its position, compared with the truth. The judge takes from here for
/// how long no right reading came: that is all that a receiver can know about a position which the joint's
/// limits allow.
///
/// The readings form runs. A run begins after a silence, or where the error of what the device shows jumps.
/// Where the error is that of the last reading of an earlier run of many readings, that run continues; not
/// past a jump to the zero. After a silence or a jump, right readings end the time without a right reading
/// only after as long again, at most 0.42 s. Nor does a single right reading end it: it and the wrong one
/// before it contradict each other, and either may be right.
class JointSight {
  public:
    struct Run {
        std::int64_t begin_ns = 0; ///< true time
        /// From the last right reading to the begin, by whichever clock is longer, and the frames that are
        /// left out where the clock was set back.
        std::int64_t blind_ns = 0;
        double error_rad = 0;     ///< of what the device shows at the begin
        double from_zero_rad = 0; ///< of what it shows there
        bool at_zero = false;     ///< it jumps there, within a period and a half's motion of its zero
        double velocity = 0;      ///< of the joint there
        int readings = 0;
    };

    /// A reading with the time since the last right one (0: it is right), and the time that the four right
    /// ones before it span (0: nothing shows the velocity).
    struct Blind {
        std::int64_t time_ns, blind_ns, span_ns;
    };

    /// What the device shows at a time.
    struct Shown {
        std::int64_t time_ns; ///< of the SYNC that the frame answers, or of the frame
        double position_rad, effort;
        bool right;      ///< the position as it was sent
        std::size_t run; ///< of `run`
    };

    JointSight(const FaultSite& site, std::size_t joint);

    /// The runs, by number.
    [[nodiscard]] const Run& run(std::size_t number) const { return runs_[number]; }

    /// Whether the device shows a value at some time from `from_ns` to `to_ns`, in a reading or on the line
    /// between two that are not far apart. Of the readings for which `counts(shown)` holds.
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

    /// The run that an instant belongs to.
    [[nodiscard]] const Run& run_at(std::int64_t true_ns) const;

    /// The one of the readings around an instant, which an interpolation may use, for which the last right
    /// one came the longest time before.
    [[nodiscard]] Blind blind_at(std::int64_t time_ns) const;

  private:
    struct Reading {
        std::int64_t true_ns, stamp_ns; ///< when it came, and its stamp
        std::int64_t time_ns;           ///< its stamp by the true clock
        double shown_rad, error_rad;
        bool right;
    };
    static bool is_on_line(const Shown& one, const Shown& next, double Shown::*what, double value,
                           double tolerance, std::int64_t from_ns, std::int64_t to_ns);
    /// Whether the joint can have moved there from the reading before: then it only passes its zero.
    [[nodiscard]] bool can_move_to(const Reading& reading, double step_rad) const;
    static bool is_right(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void show(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void examine(const FaultSite& site, std::size_t joint, const Sent& sent, std::int64_t time_ns);
    void take(Run seen, const Reading& reading);
    void begin_run(Run seen, const Reading& reading);
    [[nodiscard]] std::int64_t span_ns() const;

    std::vector<Run> runs_{Run{}};
    std::vector<Blind> blind_; ///< by time
    std::vector<Shown> shown_; ///< by time
    Reading last_{}, last_established_{};
    std::deque<std::int64_t> known_ns_; ///< times of the last right readings, since the clock was set
    std::int64_t sync_ns_ = 0;          ///< of the last SYNC
    int right_ = 0;                     ///< readings in a row
    bool set_back_ = false;             ///< the clock, since `last_established_`
    struct WrongRun {
        Run run;
        std::size_t number; ///< of runs up to it
        double error_rad;   ///< of its last reading
    };
    std::vector<WrongRun> wrong_; ///< of many readings, since `last_established_`
};

} // namespace dfdyn::tests
