// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/qualification.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/gate/run_comparison.hpp"
#include "dfdyn/hal/gate/zero_watch.hpp"
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
///   the limits allow, and not beginning at the device's own zero, unless the joint stood there. Where the
///   clock was set, it takes twenty times as many readings, unless the joint's motion leads there.
/// - A run that begins at the device's zero, away from the joint, is of an encoder that counts from where it
///   was switched on. It does not get its zero back by itself: no position is trusted any more
///   (`position_lost`) until the program starts again.
/// - Another run that does not connect is refused for as long as its readings lead from one to the next. A
///   jump or a silence that leads to where the joint can be ends it, after twenty times as many readings. So
///   do twenty times as many readings themselves where the jump was within the velocity limit.
/// - A moving joint that repeats its last reading, bit for bit, where it cannot have stopped, is frozen until
///   the readings change. So is one that returns from a silence with readings that do not change, unless it
///   was at rest and still is where it was.
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
        : config_(config), tolerance_{config.limits, config.period_ns, seconds_between(0, config.jitter_ns)},
          comparison_(tolerance_, config.max_age_ns, config.jitter_ns),
          zero_(config.limits.velocity, config.period_ns) {}

    /// Takes a reading; stamps must increase.
    constexpr Verdict take(EncoderReading reading) noexcept {
        if (zero_lost_) {
            return refuse(reading, Reason::position_lost);
        }
        if (lost() && still_lost(reading)) {
            run_ = {};
            if (jumped_little() && refused_.readings() >= most_readings()) {
                believe(MotionRun(refused_));
            }
            return refuse(reading, Reason::position_lost);
        }
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
        return follow(reading, disturbed_ ? Reason::position_jump : Reason::qualifying);
    }

    /// Takes a reading of unknown time. It is not compared, but it shows an encoder that counts from its own
    /// zero, far from where the joint was.
    constexpr void glance(EncoderReading reading) noexcept {
        unwrap_near(reading, trusted_.last().position_rad);
        const bool far = magnitude(reading.position_rad - trusted_.last().position_rad) >
                         tolerance_.reach(seconds_between(0, config_.max_age_ns), reading.step_rad);
        MotionLine motion = trusted_.end_line(0, config_.period_ns);
        motion.velocity = zero_.seen() ? config_.limits.velocity : motion.velocity;
        if (!trusted_.empty() && far && begins_at_zero(reading, motion)) {
            zero_lost_ = zero_lost_ || !reading.zero;
            zero_.saw(reading.stamp_ns);
        }
    }

    /// The device was not itself: it must qualify again.
    constexpr void interrupt() noexcept {
        restarts_ += !trusted_.empty() && !interrupted_ ? 1U : 0U;
        interrupted_ = true;
        run_ = {};
    }

    /// The time since the last trusted reading is not known any more: the clock of the stamps was set.
    constexpr void forget_time() noexcept { time_known_ = trusted_.empty() || disturbed_ || lost(); }

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
        const bool follows = comparison_.near(before.end_ns, refused_.first().stamp_ns);
        if (follows && !zero_lost_ &&
            comparison_.meets(before, refused_.begin_line(0, config_.period_ns), refused_.first(),
                              longest_s(), ShareAtZero{*this, refused_.first()})) {
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

    [[nodiscard]] constexpr bool fresh(std::int64_t stamp_ns) const noexcept {
        return !trusted_.empty() && !interrupted_ && time_known_ &&
               comparison_.near(trusted_.last().stamp_ns, stamp_ns);
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
    /// Whether a reading belongs to those that are refused, in whichever turn: tightly while they are recent,
    /// after a silence if it can. Takes it.
    constexpr bool still_lost(EncoderReading reading) noexcept {
        unwrap_near(reading, refused_.last().position_rad);
        if (comparison_.near(refused_.last().stamp_ns, reading.stamp_ns)) {
            const bool leads = refused_.leads_to(reading, tolerance_);
            if (leads) {
                refused_.extend(reading, tolerance_);
            }
            return leads;
        }
        const bool can_be = has_lost_zero() ? tolerance_.reaches(refused_.last(), reading)
                                            : recently(refused_.last().stamp_ns, reading.stamp_ns) &&
                                                  comparison_.reaches_after_silence(refused_, reading);
        const bool goes_on = can_be && !comparison_.continues(run_, reading);
        if (goes_on) {
            refused_.resume(reading, tolerance_);
        }
        return goes_on;
    }

    /// Whether the velocity limit allows what the acceleration limit does not, from one reading to the next:
    /// an impact, or a clock that was set by a few milliseconds.
    [[nodiscard]] constexpr bool jumped_little() const noexcept {
        return !zero_lost_ && tolerance_.reaches(trusted_.last(), refused_.first()) &&
               refused_.first().stamp_ns - trusted_.last().stamp_ns <= 2 * config_.period_ns;
    }

    /// Whether the readings that are refused are those of an encoder that has lost its zero, not of a fault
    /// that passes: they began at the device's zero, or are very many.
    [[nodiscard]] constexpr bool has_lost_zero() const noexcept {
        return zero_lost_ || refused_.readings() >= most_readings();
    }
    [[nodiscard]] constexpr bool recently(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
        return to_ns - from_ns <= 3 * config_.max_age_ns;
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
        if (comparison_.continues(run_, reading)) { // it is no better when it comes back, or round
            refused_ = run_;
            refused_.extend(reading, tolerance_);
        }
        run_ = {};
        note(true);
        ++beyond_;
        return refuse(reading, Reason::position_out_of_range);
    }

    constexpr Verdict trust(const EncoderReading& reading) noexcept {
        trusted_.extend(reading, tolerance_);
        refused_ = {};
        disturbed_ = false;
        zero_.forget();
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
        zero_.forget();
        time_known_ = true;
    }

    /// Counts a reading that is not trusted yet; trusts it where it ends a run that is long enough.
    constexpr Verdict follow(const EncoderReading& reading, Reason reason) noexcept {
        const bool continued = comparison_.continues(run_, reading);
        note(!continued);
        const bool recent = !run_.empty() && comparison_.near(run_.last().stamp_ns, reading.stamp_ns);
        if (!continued && recent && !changes_over(reading)) {
            return refuse(reading, reason);
        }
        if (!continued && !recent) {
            begin_run(comparison_.continues(other_, reading) ? MotionRun(other_) : MotionRun(), reading);
        }
        if (continued) {
            other_ = {};
        }
        const bool repeats = !run_.empty() && reading.position_rad == run_.last().position_rad;
        run_.extend(reading, tolerance_);
        const bool enough = run_.readings() >= config_.qualification.readings;
        if (enough && !trusted_.empty() && restarted_at_zero(run_)) {
            return lose(reading);
        }
        if (suspected_ && run_.still()) {
            return refuse(reading, repeats ? Reason::position_frozen : reason);
        }
        const bool stands_at_zero = run_.zeros() >= config_.qualification.zero_readings;
        if (!enough && !stands_at_zero) {
            return refuse(reading, reason);
        }
        if (!trusted_.empty() &&
            (!comes_from_trusted(run_) || (has_lost_zero() && goes_on_from_refused(run_)))) {
            return lose(reading);
        }
        return run_.readings() >= needed_readings() || stands_at_zero ? settle(reading)
                                                                      : refuse(reading, reason);
    }

    /// Whether this reading is one too many that does not continue the run: then those are the run. A single
    /// one that is off does not end a run.
    constexpr bool changes_over(const EncoderReading& reading) noexcept {
        constexpr int enough = 2; // and this one
        if (other_.empty() || !comparison_.continues(other_, reading)) {
            other_ = {};
            other_.extend(reading, tolerance_);
            return false;
        }
        if (other_.readings() + other_.zeros() < enough) {
            other_.extend(reading, tolerance_);
            return false;
        }
        begin_run(MotionRun(other_), reading);
        return true;
    }

    /// Takes over a run, which may be empty, that goes on with this reading.
    constexpr void begin_run(const MotionRun& run, const EncoderReading& reading) noexcept {
        const EncoderReading& first = run.empty() ? reading : run.first();
        const bool recent = comparison_.near(trusted_.last().stamp_ns, first.stamp_ns);
        suspected_ = !trusted_.empty() && (recent || trusted_.moves(tolerance_)) &&
                     (!stood_at(first) || trusted_.repeats(first, tolerance_));
        zero_.note(first);
        run_ = run;
        other_ = {};
    }

    /// Trusts the run that ends with this reading.
    constexpr Verdict settle(const EncoderReading& reading) noexcept {
        believe(MotionRun(run_));
        return settled(reading);
    }

    /// Refuses the run that ends with this reading, and what goes on from it.
    constexpr Verdict lose(const EncoderReading& reading) noexcept {
        const bool new_here = !lost() || !connects(refused_, run_);
        const bool at_zero = begins_at_zero(run_.first(), run_.begin_line(0, config_.period_ns));
        zero_lost_ = at_zero || (zero_lost_ && !new_here);
        refused_ = run_;
        run_ = {};
        return refuse(reading, Reason::position_lost);
    }

    /// Whether the joint was at rest at the last trusted reading, and is still there.
    [[nodiscard]] constexpr bool stood_at(const EncoderReading& reading) const noexcept {
        return !trusted_.moves(tolerance_) &&
               magnitude(reading.position_rad - trusted_.last().position_rad) <= 2 * reading.step_rad;
    }

    /// How many readings of the run are enough to trust it.
    [[nodiscard]] constexpr int needed_readings() const noexcept {
        const int least = config_.qualification.readings;
        if (trusted_.empty()) {
            return least;
        }
        const std::int64_t silence_ns = run_.first().stamp_ns - trusted_.last().stamp_ns;
        const bool disturbed = (!time_known_ && !comparison_.reaches_after_silence(trusted_, run_.first())) ||
                               (disturbed_ && silence_ns > 2 * config_.max_age_ns + 2 * config_.jitter_ns);
        return lost() || disturbed ? most_readings() : least;
    }
    [[nodiscard]] constexpr int most_readings() const noexcept {
        return times_when_lost * config_.qualification.readings;
    }

    [[nodiscard]] constexpr bool comes_from_trusted(const MotionRun& run) const noexcept {
        return (!time_known_ || connects(trusted_, run)) && !restarted_at_zero(run);
    }

    /// Whether a joint can have come from the end of one run to the begin of the next.
    [[nodiscard]] constexpr bool connects(const MotionRun& before, const MotionRun& run) const noexcept {
        const std::int64_t disturbed_ns = disturbed_ || lost() ? config_.max_age_ns : 0;
        if (comparison_.near(before.last().stamp_ns + disturbed_ns, run.first().stamp_ns)) {
            return comparison_.meets(before, run, longest_s(), ShareAtZero{*this, run.first()});
        }
        return tolerance_.reaches(before.last(), run.first()) &&
               comparison_.reaches_after_silence(before, run.first());
    }

    /// Whether a run is still of the encoder whose readings are refused: a small jump, or a clock that was
    /// set by a few milliseconds, does not bring its zero back.
    [[nodiscard]] constexpr bool goes_on_from_refused(const MotionRun& run) const noexcept {
        const bool small_jump = comparison_.near(refused_.last().stamp_ns, run.first().stamp_ns) &&
                                tolerance_.reaches(refused_.last(), run.first());
        return small_jump || connects(refused_, run);
    }

    /// The part of the limits that is allowed for a jump to a run: less where that begins at the encoder's
    /// zero.
    struct ShareAtZero {
        const MotionGate& gate;
        const EncoderReading& first;

        [[nodiscard]] constexpr double operator()(const MotionLine& begin) const noexcept {
            return gate.begins_at_zero(first, begin) ? 0.25 : 1.0;
        }
    };

    /// Whether a run begins where an encoder does that was switched on.
    [[nodiscard]] constexpr bool begins_at_zero(const EncoderReading& first,
                                                const MotionLine& begin) const noexcept {
        constexpr double clock_s = 0.05; // in which frames are left out while the clock is set
        const bool hidden = !time_known_ && !comparison_.reaches_after_silence(trusted_, first);
        return zero_.is_begin(first, begin.velocity, trusted_.end_line(0, config_.period_ns).velocity,
                              hidden ? clock_s : 0);
    }

    /// Whether a run after a silence begins at the device's zero; a joint that stood there before may stand
    /// there still.
    [[nodiscard]] constexpr bool restarted_at_zero(const MotionRun& run) const noexcept {
        constexpr double fastest_boot_s = 0.02;
        const bool long_enough =
            !time_known_ || seconds_between(trusted_.last().stamp_ns, run.first().stamp_ns) >= fastest_boot_s;
        return long_enough && begins_at_zero(run.first(), run.begin_line(0, config_.period_ns)) &&
               !stood_at(run.first());
    }

    Config config_;
    MotionTolerance tolerance_;
    RunComparison comparison_;
    ZeroWatch zero_;
    MotionRun trusted_;
    MotionRun run_;          ///< of readings that qualify
    MotionRun other_;        ///< of readings that do not continue the run
    MotionRun refused_;      ///< does not connect; while its readings go on they are refused
    std::uint8_t off_ = 0;   ///< which of the last eight readings led from no other, a bit each
    bool suspected_ = false; ///< the run may be of a frozen encoder
    bool disturbed_ = false; ///< a jump has come since the last trusted reading
    bool interrupted_ = false;
    bool time_known_ = true; ///< since the last trusted reading
    bool zero_lost_ = false; ///< the refused readings began at the device's zero
    std::uint64_t refusals_ = 0;
    std::uint64_t restarts_ = 0;
    std::uint64_t beyond_ = 0;
};

} // namespace dfdyn::hal
