// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/motion_evidence.hpp"
#include "dfdyn/hal/reason.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

namespace dfdyn::hal {

/// Trusts a position only if the joint can have moved to it from the last trusted position.
///
/// - A reading at most `max_age` after the last trusted one is compared with the line through the last
///   readings. Its tolerance covers the acceleration limit, encoder counts and jitter. A reading that is
///   stale, corrupted, zero, late or from another sender is rejected, and the next correct one is trusted.
/// - After a start, silence or jump, `qualification.readings` consistent readings are required, which must
///   connect with the last trusted position. After a jump, the velocity may differ (impact) but not the
///   position. After a silence, the motion limits apply. Twenty times as many are required after
///   contradictory readings, or after a clock step to an unexplained position.
/// - A run from the device's zero, without a motion to there, comes from an encoder that counts from where it
///   was switched on (ZeroWatch). It is `position_lost` until the program restarts. Exception: a run that
///   reverses the jump before it (a stuck bit). An absolute encoder has no such runs. An incremental one
///   also has doubtful runs to which it can have counted.
/// - Any other run that does not connect is rejected while it continues. It ends with a jump or a silence to
///   a position that the joint can have, after twenty times as many readings. A run after a small jump is
///   itself trusted after as many. Small: the velocity limit times two periods, or one interval if the period
///   is unknown. After fifty times as many, a loss that began with a jump ends only with the reverse jump or
///   a restart.
/// - A position that has been trusted for less time than the preceding silence or jump (at most 0.4 s) is on
///   trial. A run that connects with the earlier trusted motion and reverses most of the jump replaces it.
/// - Readings that jump five times further than the joint can move are rejected until they return, jump
///   further, or are silent for long enough (AwayWatch).
/// - A moving joint that repeats its last reading exactly, although it cannot have stopped, is frozen until
///   the readings change. So are constant readings after a silence, unless the joint was at rest there.
///
/// A wrapping integer is unwrapped if the turn is unambiguous. O(1).
class MotionGate : private MotionEvidence {
  public:
    using MotionEvidence::Config; ///< motion limits and time limits of the joint
    using MotionEvidence::lost;   ///< returns true while readings are rejected that do not connect

    /// Result for one reading.
    struct Verdict {
        Reason reason = Reason::ok; ///< ok: trusted
        double position_rad = 0;    ///< unwrapped
    };

    /// Starts without readings.
    explicit constexpr MotionGate(const Config& config) noexcept : MotionEvidence(config) {}

    /// Takes a reading and returns whether it is trusted. Stamps must increase.
    constexpr Verdict take(const EncoderReading& reading) noexcept {
        EncoderReading unwrapped = reading;
        unwrap(unwrapped);
        const bool expected = is_expected(unwrapped);
        follow_away(reading);
        const Verdict verdict = judge(reading);
        unwrapped.position_rad = verdict.position_rad;
        if (verdict.reason == Reason::ok) {
            away_.trust(unwrapped, is_established());
            zero_.forget();
        } else {
            zero_.take(unwrapped, expected);
            lose_if_counting();
        }
        return verdict;
    }

    /// Takes a reading of unknown time, which may only reveal an encoder that counts from its own zero.
    constexpr void glance(EncoderReading reading) noexcept {
        unwrap_near(reading, trusted_.last().position_rad);
        candidate_.contradict(unfit_.contradict(reading));
        const bool by_motion = is_expected(reading);
        const bool expected = by_motion || unfit_.lead_to(reading);
        counts_from_zero_ = counts_from_zero_ && !by_motion;
        const bool returns = away_.silent_s(reading.stamp_ns) >= fastest_boot_s();
        follow_away(reading);
        if (!expected && (returns || unfit_.is_far(unfit_.last_or(trusted_.last()), reading))) {
            counts_from_zero_ = !trusted_.empty() && !stood_at(reading) &&
                                (zero_.lead_to_untimed(reading) ||
                                 begins_at_zero(reading, trusted_.end_line(0, config_.period_ns)));
        }
        zero_lost_ = zero_lost_ || (counts_from_zero_ && !reading.zero);
        unfit_.take_untimed(reading);
    }

    /// Requires more readings, because the readings contradict each other.
    constexpr void contradict() noexcept { candidate_.contradict(true); }

    /// Takes a reading that the device marked as not ready: the device must qualify again.
    constexpr void interrupt(EncoderReading reading) noexcept {
        unwrap(reading);
        restarts_ += !trusted_.empty() && !interrupted_ ? 1U : 0U;
        interrupted_ = true;
        candidate_.contradict((!reading.zero && candidate_.disputes(reading, comparison_)) ||
                              unfit_.contradict(reading));
        candidate_.interrupt();
        unfit_.take(reading);
        away_.hear(reading.stamp_ns);
        zero_.take(reading, is_expected(reading));
    }

    /// Forgets the time since the last trusted reading, because the clock of the stamps was set.
    constexpr void forget_time() noexcept {
        time_known_ = trusted_.empty() || disturbed_ || lost();
        established_ = {};
        away_.forget();
        refused_time_known_ = !lost();
    }

    /// Trusts the readings of a lost joint if a clock step of `step_ns` explains their offset. They must
    /// follow the last trusted reading without a silence. Requires that other sources show the same clock
    /// step.
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

    /// Returns the last trusted position (rad); none before the first.
    [[nodiscard]] constexpr std::optional<double> position_rad() const noexcept {
        return trusted_.empty() ? std::nullopt : std::optional(trusted_.last().position_rad);
    }

    /// Returns the number of rejected readings.
    [[nodiscard]] constexpr std::uint64_t refusals() const noexcept { return refusals_; }
    /// Returns how many times the device was not ready after it had been trusted.
    [[nodiscard]] constexpr std::uint64_t restarts() const noexcept { return restarts_; }
    /// Returns the number of readings beyond the joint's range.
    [[nodiscard]] constexpr std::uint64_t beyond() const noexcept { return beyond_; }

  private:
    /// Passes a reading to `away_`.
    constexpr void follow_away(EncoderReading reading) noexcept {
        if (!trusted_.empty() && !reading.zero && unwrap(reading)) { // a zero gives no position
            away_.take(reading);
        }
        away_.hear(reading.stamp_ns);
    }

    /// Marks the joint as lost if many readings count from the zero, even if other readings came between
    /// them.
    constexpr void lose_if_counting() noexcept {
        const MotionRun& counted = zero_.counted();
        if (!zero_lost_ && !trusted_.empty() && counted.readings() >= 2 * config_.qualification.readings &&
            !counted.still() && restarted_at_zero(counted)) {
            begin_loss(MotionRun(counted));
            zero_lost_ = true;
        }
    }

    constexpr Verdict judge(EncoderReading reading) noexcept {
        if (zero_lost_) {
            return refuse(reading, Reason::position_lost);
        }
        if (lost() && still_lost(reading)) {
            candidate_.interrupt();
            count_lost(1);
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
                note(candidate_.disputes(reading, comparison_)); // either of the two may be wrong
                candidate_.clear();
                return trust(reading);
            }
            const bool frozen = trusted_.repeats(reading, tolerance_);
            disturbed_ = !frozen;
            return follow(reading, frozen ? Reason::position_frozen : Reason::position_jump);
        }
        return follow(reading, disturbed_ ? Reason::position_jump : Reason::qualifying);
    }

    /// Returns true if a reading, in any turn, continues the rejected ones, and takes it. The tolerance is
    /// that of consecutive readings, or after a silence that of the motion limits.
    constexpr bool still_lost(EncoderReading reading) noexcept {
        unwrap_near(reading, refused_.last().position_rad);
        if (refused_time_known_ && comparison_.near(refused_.last().stamp_ns, reading.stamp_ns)) {
            const bool leads = refused_.leads_to(reading, tolerance_);
            if (leads) {
                refused_.extend(reading, tolerance_);
            }
            return leads;
        }
        const bool reached = tolerance_.reaches(refused_.last(), reading) &&
                             (has_lost_zero() || (recently(refused_.last().stamp_ns, reading.stamp_ns) &&
                                                  comparison_.reaches_after_silence(refused_, reading)));
        const bool same = refused_.readings() >= config_.qualification.readings &&
                          (candidate_.silent_before(reading, comparison_) || !refused_time_known_) &&
                          comparison_.goes_on_without_silence(refused_, reading);
        const bool can_be = same || (refused_time_known_ ? reached : has_lost_zero());
        const bool goes_on = can_be && !comparison_.continues(run(), reading);
        if (goes_on) {
            refused_time_known_ = true;
            refused_.resume(reading, tolerance_);
        }
        return goes_on;
    }

    constexpr Verdict refuse(const EncoderReading& reading, Reason reason) noexcept {
        ++refusals_;
        return {reason, reading.position_rad};
    }

    constexpr Verdict take_beyond_range(const EncoderReading& reading) noexcept {
        const bool jumped = lost() || magnitude(jump_rad_) > 2 * jump_error_rad_;
        if (jumped && comparison_.continues(run(), reading)) { // rejected also when it returns or wraps
            begin_loss(run());
            refused_.extend(reading, tolerance_);
        }
        candidate_.interrupt();
        note(true);
        ++beyond_;
        return refuse(reading, Reason::position_out_of_range);
    }

    constexpr Verdict trust(const EncoderReading& reading) noexcept {
        trusted_.extend(reading, tolerance_);
        end_loss();
        forget_unfit();
        disturbed_ = false;
        return checked(reading);
    }

    /// Rejects a reading if two of the last eight were inconsistent: the others may be the wrong ones.
    constexpr Verdict checked(const EncoderReading& reading) noexcept {
        return std::popcount(off_) < 2 ? Verdict{Reason::ok, reading.position_rad}
                                       : refuse(reading, Reason::position_jump);
    }
    constexpr void note(bool off) noexcept {
        off_ = static_cast<std::uint8_t>(static_cast<unsigned>(off_) << 1U | (off ? 1U : 0U));
    }

    constexpr void believe(const MotionRun& run) noexcept {
        replace_trusted(run);
        candidate_.clear();
        forget_unfit();
        end_loss();
        interrupted_ = false;
        disturbed_ = false;
        time_known_ = true;
    }

    /// Counts an untrusted reading; trusts it if it completes a run that is long enough.
    constexpr Verdict follow(const EncoderReading& reading, Reason reason) noexcept {
        const bool expected = is_expected(reading);
        const bool repeats = !run().empty() && reading.position_rad == run().last().position_rad;
        if (broke_off_at_zero(reading)) {
            return lose(reading);
        }
        candidate_.contradict(unfit_.contradict(reading));
        const CandidateRun::Step step = candidate_.take(reading, comparison_, tolerance_);
        note(step != CandidateRun::Step::continues);
        if (step == CandidateRun::Step::is_off) {
            return refuse(reading, reason);
        }
        if (step == CandidateRun::Step::begins) {
            note_jump();
            suspected_ = may_be_frozen(run().first());
            expected_ = expected && run().readings() == 1;
        }
        const bool enough = run().readings() >= config_.qualification.readings;
        if (enough && !trusted_.empty() && !expected_ && restarted_at_zero(run())) {
            return lose(reading);
        }
        suspected_ = suspected_ || trusted_.repeats(reading, tolerance_);
        if (suspected_ && run().still()) {
            return refuse(reading, repeats ? Reason::position_frozen : reason);
        }
        const bool at_rest_at_zero = run().zeros() >= config_.qualification.zero_readings;
        if (!enough && !at_rest_at_zero) {
            return refuse(reading, reason);
        }
        const bool doubtful = is_doubtful();
        if (!trusted_.empty() &&
            (!comes_from_trusted(run(), expected_) || (has_lost_zero() && goes_on_from_refused(run())) ||
             stays_elsewhere() || away_.away() || (doubtful && may_count_from_zero(run())))) {
            return lose(reading);
        }
        if (doubtful && run().readings() < most_readings() && !at_rest_at_zero) {
            return refuse(reading, reason);
        }
        believe(MotionRun(run()));
        return checked(reading);
    }

    /// Rejects the run that ends with this reading, and its continuation.
    constexpr Verdict lose(const EncoderReading& reading) noexcept {
        const bool new_here = !lost() || !connects(refused_, run());
        const bool at_zero =
            (begins_at_zero(run()) && !reverses_jump_before(run())) || may_count_from_zero(run());
        zero_lost_ = at_zero || (zero_lost_ && !new_here);
        begin_loss(run());
        candidate_.interrupt();
        return refuse(reading, Reason::position_lost);
    }

    /// Rejects a run and its continuation. A loss that has begun keeps its jump and its count.
    constexpr void begin_loss(const MotionRun& run) noexcept {
        if (!lost()) {
            lost_jump_rad_ = magnitude(jump_rad_) > 2 * jump_error_rad_ ? jump_rad_ : 0;
        }
        refused_ = run;
        count_lost(run.readings());
    }
    constexpr void end_loss() noexcept {
        refused_ = {};
        lost_readings_ = 0;
        lost_jump_rad_ = 0;
        forget_jumps();
    }
    constexpr void count_lost(int readings) noexcept {
        lost_readings_ = std::min(lost_readings_ + readings, most_lost_readings());
    }

    /// Returns true if the limits allow any position after such a long loss, and the run does not reverse the
    /// jump with which the loss began.
    [[nodiscard]] constexpr bool stays_elsewhere() const noexcept {
        return lost_readings_ == most_lost_readings() && lost_jump_rad_ != 0 &&
               !reverses_jump(lost_jump_rad_);
    }

    double lost_jump_rad_ = 0; ///< jump with which the loss began; 0: a silence
    std::uint8_t off_ = 0;     ///< bit mask of the last eight readings; 1: inconsistent
    std::uint64_t refusals_ = 0, restarts_ = 0, beyond_ = 0;
};

} // namespace dfdyn::hal
