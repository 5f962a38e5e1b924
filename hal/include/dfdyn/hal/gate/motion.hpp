// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/motion_run.hpp"
#include "dfdyn/hal/gate/qualification.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/reason.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace dfdyn::hal {

/// Believes a position only if the joint's motion leads to it from the last one that was believed.
///
/// - A reading within `max_age` of the last trusted one is compared with where the joint must be: on the line
///   through its last readings, as far off as acceleration limit, counts and jitter allow. A value that is
///   stale, flipped, zero, of another sender or of an earlier time is refused, and the next true one is
///   trusted at once.
/// - Otherwise (start, silence, jump) it takes `qualification.readings` consecutive readings that lead from
///   one to the next. They also must connect with the last trusted position. After a jump between two
///   readings: velocity may change at once (an impact), position may not. After a silence: no further than
///   the limits allow, and not beginning at the device's own zero, unless the joint stood there.
/// - A run that does not connect is refused for as long as its readings lead from one to the next
///   (`position_lost`): an encoder that counts from where it was switched on does not get its zero back by
///   time. A jump to where the joint can be ends it, after twenty times as many readings.
/// - A moving joint that repeats its last reading, bit for bit, where it cannot have stopped, is frozen until
///   the reading changes. A joint that stopped within its limits may repeat its reading for ever.
///
/// An integer that wraps is unwrapped where a single turn can be meant. O(1).
class MotionGate {
  public:
    struct Config {
        MotionLimits limits;
        Range range{-7, 7}; ///< rad
        std::int64_t max_age_ns = 0;
        std::int64_t period_ns = 0; ///< of the readings; 0: not known
        std::int64_t jitter_ns = 0; ///< largest lateness of a stamp against another one
        QualificationGate::Config qualification;
    };

    struct Verdict {
        Reason reason = Reason::ok;
        double position_rad = 0; ///< unwrapped
    };

    explicit constexpr MotionGate(const Config& config) noexcept
        : config_(config), tolerance_{config.limits, config.period_ns, seconds_between(0, config.jitter_ns)} {
    }

    /// Takes a reading; stamps must increase.
    constexpr Verdict take(EncoderReading reading) noexcept {
        if (!unwrap(reading)) {
            return refuse(reading, Reason::position_lost);
        }
        if (!(reading.position_rad >= config_.range.lowest &&
              reading.position_rad <= config_.range.highest)) {
            return take_beyond_range(reading);
        }
        if (fresh(reading.stamp_ns)) {
            if (leads_from_trusted(reading)) {
                run_ = {};
                note(false);
                return trust(reading);
            }
            const bool frozen = trusted_.repeats(reading, tolerance_);
            disturbed_ = !frozen;
            return follow(reading, frozen ? Reason::position_frozen : Reason::position_jump);
        }
        if (lost() && !continues(run_, reading) && still_lost(reading)) {
            run_ = {};
            return refuse(reading, Reason::position_lost);
        }
        return follow(reading, disturbed_ ? Reason::position_jump : Reason::qualifying);
    }

    /// The device was not itself: it must qualify again.
    constexpr void interrupt() noexcept {
        restarts_ += !trusted_.empty() && !interrupted_ ? 1U : 0U;
        interrupted_ = true;
        run_ = {};
    }

    /// Believes the readings of a lost joint, if a clock that was set by this much explains where they are:
    /// they follow at once after the last trusted reading, by the clock as it was set. After a silence
    /// nothing shows that. To be called only where other sources show that the clock was set.
    constexpr void explain_by_clock(std::int64_t step_ns) noexcept {
        if (!lost()) {
            return;
        }
        MotionLine before = trusted_.end_line(0, config_.period_ns);
        before.begin_ns += step_ns;
        before.end_ns += step_ns;
        const bool follows = near(before.end_ns, refused_.first().stamp_ns);
        if (follows && meets(before, refused_.begin_line(0, config_.period_ns), refused_.first())) {
            believe(MotionRun(refused_));
        }
    }

    /// The last trusted position; 0 before the first.
    [[nodiscard]] constexpr double position_rad() const noexcept { return trusted_.last().position_rad; }

    [[nodiscard]] constexpr bool lost() const noexcept { return !refused_.empty(); }
    [[nodiscard]] constexpr std::uint64_t refusals() const noexcept { return refusals_; }
    [[nodiscard]] constexpr std::uint64_t restarts() const noexcept { return restarts_; }
    [[nodiscard]] constexpr std::uint64_t beyond() const noexcept { return beyond_; }

  private:
    static constexpr int times_when_lost = 20;

    [[nodiscard]] constexpr bool near(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
        return to_ns - from_ns <= config_.max_age_ns + 2 * config_.jitter_ns;
    }
    [[nodiscard]] constexpr bool fresh(std::int64_t stamp_ns) const noexcept {
        return !trusted_.empty() && !interrupted_ && near(trusted_.last().stamp_ns, stamp_ns);
    }
    /// After a jump, the time that passes does not make the positions that it led to more likely: from here
    /// on it allows no larger distance.
    [[nodiscard]] constexpr double longest_s() const noexcept {
        return disturbed_ && config_.period_ns > 0 ? 1.5 * seconds_between(0, config_.period_ns)
                                                   : MotionRun::unlimited_s;
    }
    [[nodiscard]] constexpr bool leads_from_trusted(const EncoderReading& reading) const noexcept {
        return trusted_.leads_to(reading, tolerance_, longest_s());
    }
    [[nodiscard]] constexpr bool continues(const MotionRun& run, const EncoderReading& to) const noexcept {
        return !run.empty() && near(run.last().stamp_ns, to.stamp_ns) && run.leads_to(to, tolerance_);
    }
    /// Whether a reading belongs to those that are refused: tightly while they are recent, after a silence if
    /// it can. Takes it.
    constexpr bool still_lost(const EncoderReading& reading) noexcept {
        if (near(refused_.last().stamp_ns, reading.stamp_ns)) {
            const bool leads = refused_.leads_to(reading, tolerance_);
            if (leads) {
                refused_.extend(reading, tolerance_);
            }
            return leads;
        }
        const bool reaches = tolerance_.reaches(refused_.last(), reading);
        if (reaches) {
            refused_.resume(reading, tolerance_);
        }
        return reaches;
    }

    /// The turn that is meant, if it is clear: the range has room for one only, or the last reading is near.
    /// The first reading is taken as it is.
    [[nodiscard]] constexpr bool unwrap(EncoderReading& reading) const noexcept {
        if (has_one_turn(config_.range, reading.wrap_rad)) {
            unwrap_near(reading, 0.5 * (config_.range.highest + config_.range.lowest));
            return true;
        }
        const MotionRun& known = run_.empty() ? trusted_ : run_;
        if (known.empty() || !(reading.wrap_rad > 0)) {
            return true;
        }
        unwrap_near(reading, known.last().position_rad);
        const double dt_s = seconds_between(known.last().stamp_ns, reading.stamp_ns);
        return tolerance_.reach(dt_s, reading.step_rad) < 0.5 * reading.wrap_rad;
    }

    constexpr Verdict refuse(const EncoderReading& reading, Reason reason) noexcept {
        ++refusals_;
        return {reason, reading.position_rad};
    }

    constexpr Verdict take_beyond_range(const EncoderReading& reading) noexcept {
        run_ = {};
        note(true);
        ++beyond_;
        if (lost()) {
            refused_.extend(reading, tolerance_); // it is no better when it comes back
        }
        return refuse(reading, Reason::position_out_of_range);
    }

    constexpr Verdict trust(const EncoderReading& reading) noexcept {
        newest_ns_ = reading.stamp_ns;
        trusted_.extend(reading, tolerance_);
        refused_ = {};
        disturbed_ = false;
        return settled(reading);
    }

    /// Where two of eight readings were off, the others prove nothing: they may be the wrong ones.
    constexpr Verdict settled(const EncoderReading& reading) noexcept {
        return std::popcount(off_) < 2 ? Verdict{Reason::ok, reading.position_rad}
                                       : refuse(reading, Reason::position_jump);
    }
    constexpr void note(bool off) noexcept {
        off_ = static_cast<std::uint8_t>(static_cast<unsigned>(off_) << 1U | (off ? 1U : 0U));
    }

    constexpr void believe(const MotionRun& run) noexcept {
        trusted_ = run;
        run_ = {};
        refused_ = {};
        interrupted_ = false;
        disturbed_ = false;
    }

    /// Counts a reading that is not trusted yet; trusts it where it ends a run that is long enough.
    constexpr Verdict follow(const EncoderReading& reading, Reason reason) noexcept {
        const bool continued = continues(run_, reading);
        note(!continued);
        if (!continued) {
            if (run_.readings() > 1 && near(run_.last().stamp_ns, reading.stamp_ns)) {
                return refuse(reading, reason); // a single one that is off does not end a run
            }
            run_ = {};
            suspected_ = near(newest_ns_, reading.stamp_ns) && trusted_.moves(tolerance_);
        }
        newest_ns_ = reading.stamp_ns;
        const bool second = !run_.empty();
        run_.extend(reading, tolerance_);
        const bool unmoved = suspected_ && !run_.changed();
        const bool disturbed =
            disturbed_ && !near(trusted_.last().stamp_ns + config_.max_age_ns, run_.first().stamp_ns);
        const int times = lost() || disturbed ? times_when_lost : 1;
        const bool enough = run_.readings() >= times * config_.qualification.readings ||
                            run_.zeros() >= config_.qualification.zero_readings;
        if (unmoved || !enough) {
            return refuse(reading, unmoved && second ? Reason::position_frozen : reason);
        }
        if (!trusted_.empty() && !connects(run_)) {
            refused_ = run_;
            run_ = {};
            return refuse(reading, Reason::position_lost);
        }
        believe(MotionRun(run_));
        return settled(reading);
    }

    /// Whether the joint can have come from its last trusted position to where the run begins.
    [[nodiscard]] constexpr bool connects(const MotionRun& run) const noexcept {
        if (near(trusted_.last().stamp_ns + (disturbed_ ? config_.max_age_ns : 0), run.first().stamp_ns)) {
            return meets(run);
        }
        return tolerance_.reaches(trusted_.last(), run.first()) && comes_from_motion(run) &&
               !restarted_at_zero(run);
    }

    /// Whether the motions before and after a jump meet in between. Either may have one reading that is off.
    [[nodiscard]] constexpr bool meets(const MotionRun& run) const noexcept {
        const std::int64_t period_ns = config_.period_ns;
        const MotionLine from = trusted_.end_line(0, period_ns);
        const MotionLine to = run.begin_line(0, period_ns);
        return meets(trusted_.end_line(1, period_ns), to, run.first()) ||
               meets(from, run.begin_line(1, period_ns), run.first()) || meets(from, to, run.first());
    }
    [[nodiscard]] constexpr bool meets(const MotionLine& from, const MotionLine& to,
                                       const EncoderReading& first) const noexcept {
        if (from.span_s <= 0 || to.span_s <= 0) {
            return false;
        }
        const double dt_s = std::min(seconds_between(from.end_ns, to.begin_ns), longest_s());
        const double before = to.at(from.end_ns) - from.end_rad;
        const double after = to.at(to.begin_ns) - from.at(to.begin_ns);
        const double limit =
            0.5 * (tolerance_.error(from, dt_s, first.step_rad) + tolerance_.error(to, dt_s, first.step_rad));
        const double fastest =
            magnitude(from.velocity) + config_.limits.acceleration * (dt_s + from.span_s + to.span_s);
        if (magnitude(to.velocity) > fastest) { // an impact takes velocity, and turns it round
            return false;
        }
        const double nearest = std::min(magnitude(before), magnitude(after));
        return before * after <= 0 || nearest <= (begins_at_zero(first, to) ? 0.25 : 1) * limit;
    }

    /// Whether the acceleration limit may have taken the joint to the run's begin during a silence.
    [[nodiscard]] constexpr bool comes_from_motion(const MotionRun& run) const noexcept {
        bool reached = false;
        for (const int skip : {0, 1}) {
            const MotionLine line = trusted_.end_line(skip, config_.period_ns);
            const double dt_s = seconds_between(line.end_ns, run.first().stamp_ns);
            const double off = magnitude(run.first().position_rad - line.at(run.first().stamp_ns));
            reached =
                reached || line.span_s <= 0 || off <= tolerance_.error(line, dt_s, run.first().step_rad);
        }
        return reached;
    }

    /// Whether a run begins where an encoder does that was switched on: at its own zero, or as far from it as
    /// the joint goes in a few periods.
    [[nodiscard]] constexpr bool begins_at_zero(const EncoderReading& first,
                                                const MotionLine& begin) const noexcept {
        constexpr double periods = 1.5;
        const double moved = magnitude(begin.velocity) * periods * seconds_between(0, config_.period_ns);
        return magnitude(first.from_zero_rad) <= moved + 3 * first.step_rad;
    }

    /// Whether a run after a silence begins at the device's zero; a joint that stood there before may stand
    /// there still.
    [[nodiscard]] constexpr bool restarted_at_zero(const MotionRun& run) const noexcept {
        constexpr double fastest_boot_s = 0.02;
        const double still = 4 * run.first().step_rad;
        const bool stood_there = magnitude(trusted_.last().from_zero_rad) <= still &&
                                 magnitude(run.first().from_zero_rad) <= still;
        return seconds_between(trusted_.last().stamp_ns, run.first().stamp_ns) >= fastest_boot_s &&
               begins_at_zero(run.first(), run.begin_line(0, config_.period_ns)) && !stood_there;
    }

    Config config_;
    MotionTolerance tolerance_;
    MotionRun trusted_;
    MotionRun run_;              ///< of readings that qualify
    MotionRun refused_;          ///< does not connect; while its readings go on they are refused
    std::int64_t newest_ns_ = 0; ///< of any reading in the range
    std::uint8_t off_ = 0;       ///< which of the last eight readings led from no other, a bit each
    bool suspected_ = false;     ///< the run may be of a frozen encoder: begun where the joint moved
    bool disturbed_ = false;     ///< a jump has come since the last trusted reading
    bool interrupted_ = false;
    std::uint64_t refusals_ = 0;
    std::uint64_t restarts_ = 0;
    std::uint64_t beyond_ = 0;
};

} // namespace dfdyn::hal
