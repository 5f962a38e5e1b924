// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/gate/range.hpp"
#include "dfdyn/hal/motion/away_watch.hpp"
#include "dfdyn/hal/motion/candidate_run.hpp"
#include "dfdyn/hal/motion/startup.hpp"
#include "dfdyn/hal/motion/unfit_readings.hpp"
#include "dfdyn/hal/motion/zero_watch.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace dfdyn::hal {

/// Decides for MotionGate which state explains a run of encoder readings: the joint's motion (`trusted_`), an
/// encoder that restarted and counts from its zero (`zero_`), or a wrong position (`refused_`). `candidate_`
/// is undecided. O(1).
class MotionEvidence {
  public:
    /// Motion limits and time limits of a joint.
    struct Config {
        MotionLimits limits;               ///< of the joint
        Range range{-7, 7};                ///< rad
        std::int64_t max_age_ns = 0;       ///< largest age of a valid reading
        std::int64_t period_ns = 0;        ///< of the readings; 0: unknown
        std::int64_t jitter_ns = 0;        ///< largest delay of a stamp relative to another one
        StartupGate::Config qualification; ///< number of readings required
    };

  protected:
    /// Starts without readings.
    explicit constexpr MotionEvidence(const Config& config) noexcept
        : config_(config), tolerance_{config.limits, config.period_ns, seconds_between(0, config.jitter_ns)},
          comparison_(tolerance_, config.max_age_ns, config.jitter_ns),
          zero_(tolerance_, config.max_age_ns + 2 * config.jitter_ns),
          away_(tolerance_, config.max_age_ns + 2 * config.jitter_ns),
          unfit_(tolerance_, config.max_age_ns, config.jitter_ns) {}

    static constexpr int times_when_lost = 20; ///< factor on the number of readings after a contradiction
    static constexpr std::int64_t longest_trial_ns = 400'000'000; ///< largest trial of trusted readings
    static constexpr double clock_s = 0.05; ///< largest gap in the frames while the clock is set

    /// Returns true while readings are rejected that do not connect with the trusted ones.
    [[nodiscard]] constexpr bool lost() const noexcept { return !refused_.empty(); }

    /// Fraction of the motion limits allowed for a jump to a run; smaller at the encoder's zero.
    struct ShareAtZero {
        const MotionEvidence& evidence; ///< of the joint
        const EncoderReading& first;    ///< first reading of the run

        /// Returns the fraction.
        [[nodiscard]] constexpr double operator()(const MotionLine& begin) const noexcept {
            return evidence.begins_at_zero(first, begin) ? 0.25 : 1.0;
        }
    };

    /// Returns true if a motion seen shortly before, trusted or not, may lead to this reading. An untrusted
    /// motion that itself began at the encoder's zero does not count.
    [[nodiscard]] constexpr bool is_expected(const EncoderReading& reading) const noexcept {
        const auto leads = [&](const MotionRun& before, std::int64_t longest_ns) {
            return !before.empty() && reading.stamp_ns - before.last().stamp_ns <= longest_ns &&
                   tolerance_.reaches(before.last(), reading) &&
                   comparison_.reaches_after_silence(before, reading);
        };
        const auto untrusted_leads = [&](const MotionRun& before, std::int64_t longest_ns) {
            const MotionLine begin = before.begin_line(0, config_.period_ns);
            return leads(before, longest_ns) && begin.span_s > 0 && !begins_at_zero(before.first(), begin);
        };
        const std::int64_t short_ns = 3 * config_.max_age_ns;
        return leads(trusted_, short_ns) || untrusted_leads(refused_, short_ns) ||
               untrusted_leads(candidate_.run(), short_ns) || untrusted_leads(candidate_.other(), short_ns) ||
               untrusted_leads(candidate_.before(), 2 * short_ns);
    }

    /// Returns true if the last trusted reading is recent.
    [[nodiscard]] constexpr bool fresh(std::int64_t stamp_ns) const noexcept {
        return !trusted_.empty() && !interrupted_ && time_known_ &&
               comparison_.near(trusted_.last().stamp_ns, stamp_ns);
    }

    /// Returns the longest time (s) for which the tolerance grows. After a jump, elapsed time does not make
    /// the new positions more likely.
    [[nodiscard]] constexpr double longest_s() const noexcept {
        return disturbed_ && config_.period_ns > 0 ? 1.5 * seconds_between(0, config_.period_ns)
                                                   : MotionRun::unlimited_s;
    }

    /// Returns true if the motion of the trusted readings leads to this one.
    [[nodiscard]] constexpr bool leads_from_trusted(const EncoderReading& reading) const noexcept {
        return trusted_.leads_to(reading, tolerance_, longest_s());
    }

    /// Returns true if the readings jumped at most as far as the velocity limit allows in two periods (if the
    /// period is unknown: in the time between them), after a short silence at most. Causes: an impact, or a
    /// clock step of a few milliseconds.
    [[nodiscard]] constexpr bool jumped_little() const noexcept {
        const EncoderReading& from = trusted_.last();
        const EncoderReading& to = refused_.first();
        const std::int64_t apart_ns = to.stamp_ns - from.stamp_ns;
        if (apart_ns <= 0) {
            return false;
        }
        const double dt_s = seconds_between(0, config_.period_ns > 0 ? 2 * config_.period_ns : apart_ns);
        return !zero_lost_ && recently(from.stamp_ns, to.stamp_ns) &&
               magnitude(to.position_rad - from.position_rad) <= tolerance_.reach(dt_s, to.step_rad);
    }

    /// Returns true if the rejected readings come from an encoder that has lost its zero, not from a
    /// temporary fault: they began at the device's zero, or there are very many.
    [[nodiscard]] constexpr bool has_lost_zero() const noexcept {
        return zero_lost_ || lost_readings_ >= most_readings();
    }

    /// Returns true if two stamps are separated by a short silence at most.
    [[nodiscard]] constexpr bool recently(std::int64_t from_ns, std::int64_t to_ns) const noexcept {
        return to_ns - from_ns <= 3 * config_.max_age_ns;
    }

    /// Unwraps a reading. Returns true if the turn is unambiguous: the last reading is near, or no other turn
    /// lies within the range. The first reading is not changed.
    constexpr bool unwrap(EncoderReading& reading) const noexcept {
        if (has_one_turn(config_.range, reading.wrap_rad)) {
            unwrap_within(reading, config_.range);
            return true;
        }
        const MotionRun& known = run().empty() ? trusted_ : run();
        if (known.empty() || !(reading.wrap_rad > 0)) {
            return true;
        }
        unwrap_near(reading, known.last().position_rad);
        const double dt_s = seconds_between(known.last().stamp_ns, reading.stamp_ns);
        const bool near = tolerance_.reach(dt_s, reading.step_rad) < 0.5 * reading.wrap_rad;
        return near || unwrap_within(reading, config_.range);
    }

    /// Returns the undecided run.
    [[nodiscard]] constexpr const MotionRun& run() const noexcept { return candidate_.run(); }

    /// Returns true if a silence ends a run that began at the encoder's zero, too short to be judged.
    [[nodiscard]] constexpr bool broke_off_at_zero(const EncoderReading& reading) const noexcept {
        constexpr int min_readings = 3;
        return !trusted_.empty() && run().readings() >= min_readings &&
               !comparison_.near(run().last().stamp_ns, reading.stamp_ns) && begins_at_zero(run()) &&
               !comes_from_trusted(run(), expected_);
    }

    /// Returns true if a run that begins with this reading may come from a frozen encoder.
    [[nodiscard]] constexpr bool may_be_frozen(const EncoderReading& first) const noexcept {
        const bool recent = comparison_.near(trusted_.last().stamp_ns, first.stamp_ns);
        return !trusted_.empty() && (recent || unfit_.moved() || trusted_.moves(tolerance_)) &&
               (!stood_at(first) || trusted_.repeats(first, tolerance_));
    }

    /// Forgets the unfit readings, because the joint is trusted.
    constexpr void forget_unfit() noexcept {
        unfit_.clear();
        counts_from_zero_ = false;
    }

    /// Returns true if the joint was at rest at the last trusted reading and has the same position now.
    [[nodiscard]] constexpr bool stood_at(const EncoderReading& reading) const noexcept {
        return !trusted_.moves(tolerance_) &&
               magnitude(reading.position_rad - trusted_.last().position_rad) <= 2 * reading.step_rad;
    }

    /// Returns true if the run must be long to be trusted.
    [[nodiscard]] constexpr bool is_doubtful() const noexcept {
        const std::int64_t silence_ns = run().first().stamp_ns - trusted_.last().stamp_ns;
        const bool disturbed =
            (!time_known_ && !(reaches_hidden(run().first()) &&
                               comparison_.reaches_after_silence(trusted_, run().first()))) ||
            (disturbed_ && silence_ns > 2 * config_.max_age_ns + 2 * config_.jitter_ns);
        const bool apart = time_known_ && !connects(trusted_, run());
        return !trusted_.empty() && (lost() || disturbed || apart || candidate_.contradicted());
    }

    /// Returns the number of readings required after a contradiction.
    [[nodiscard]] constexpr int most_readings() const noexcept {
        return times_when_lost * config_.qualification.readings;
    }

    /// Number of rejected readings after which a position within the limits is no evidence.
    [[nodiscard]] constexpr int most_lost_readings() const noexcept {
        return 50 * config_.qualification.readings;
    }

    /// Returns true if a reading can be reached after a clock step, during which frames were omitted.
    [[nodiscard]] constexpr bool reaches_hidden(const EncoderReading& reading) const noexcept {
        const std::int64_t since_ns = reading.stamp_ns - trusted_.last().stamp_ns;
        return comparison_.comes_within(trusted_, reading,
                                        std::max(0.0, seconds_between(0, since_ns)) + clock_s);
    }

    /// Returns true if the run continues the trusted readings and is not that of a restarted encoder.
    [[nodiscard]] constexpr bool comes_from_trusted(const MotionRun& run, bool expected) const noexcept {
        const bool connected = !time_known_ || connects(trusted_, run);
        const bool from_afar = time_known_ && unfit_.lead_from_afar(trusted_.last(), run.first());
        return ((connected && !from_afar) || comes_from_established(run)) &&
               (expected || !restarted_at_zero(run));
    }

    /// Returns true if the readings have been trusted for as long as the preceding silence or jump (at most
    /// `longest_trial_ns`). Then earlier readings are no evidence against them.
    [[nodiscard]] constexpr bool is_established() const noexcept {
        return established_.empty() || trusted_.last().stamp_ns >= trial_end_ns_;
    }

    /// Returns true if the run continues readings that were trusted for longer than the last ones, which may
    /// be faulty. It must begin soon after the last ones, with a jump that reverses most of their offset from
    /// the line of the earlier ones.
    [[nodiscard]] constexpr bool comes_from_established(const MotionRun& run) const noexcept {
        return !is_established() && run.first().stamp_ns < trial_end_ns_ &&
               comparison_.takes_back(established_, trusted_, run, longest_trial_ns) &&
               !begins_at_zero(run) && tolerance_.reaches(established_.last(), run.first()) &&
               comparison_.reaches_after_silence(established_, run.first());
    }

    /// Trusts a run.
    constexpr void replace_trusted(const MotionRun& run) noexcept {
        if (is_established()) {
            established_ = trusted_;
        }
        const std::int64_t silence_ns = run.first().stamp_ns - established_.last().stamp_ns;
        trial_end_ns_ = run.last().stamp_ns + std::min(silence_ns, longest_trial_ns);
        trusted_ = run;
    }

    /// Records the distance between the new run and the readings before it; 0 after a silence.
    constexpr void note_jump() noexcept {
        const EncoderReading& first = run().first();
        const MotionRun* before = &trusted_;
        for (const MotionRun* other : std::array{&std::as_const(refused_), &candidate_.before()}) {
            const bool later = other->last().stamp_ns > before->last().stamp_ns;
            before = !other->empty() && later && other->last().stamp_ns < first.stamp_ns ? other : before;
        }
        jump_before_rad_ = jump_rad_;
        jump_before_ns_ = jump_ns_;
        jump_ns_ = first.stamp_ns;
        const MotionLine line = before->end_line(0, config_.period_ns);
        const bool follows = !before->empty() && comparison_.near(before->last().stamp_ns, first.stamp_ns);
        jump_rad_ = follows ? first.position_rad - line.at(first.stamp_ns) : 0;
        jump_error_rad_ =
            line.span_s > 0
                ? tolerance_.error(line, seconds_between(line.end_ns, first.stamp_ns), first.step_rad)
                : tolerance_.reach(seconds_between(line.end_ns, first.stamp_ns), first.step_rad);
    }

    /// Forgets the jumps before a trusted reading.
    constexpr void forget_jumps() noexcept { jump_rad_ = jump_before_rad_ = 0; }

    /// Returns true if a run reverses the jump shortly before it, as a temporarily stuck bit does. A
    /// restarted encoder goes to its zero from any position of the joint.
    [[nodiscard]] constexpr bool reverses_jump_before(const MotionRun& run) const noexcept {
        const std::int64_t apart_ns = run.first().stamp_ns - jump_ns_;
        return apart_ns <= config_.max_age_ns && -apart_ns <= config_.max_age_ns &&
               run.first().stamp_ns - jump_before_ns_ <= longest_trial_ns && reverses_jump(jump_before_rad_);
    }

    /// Returns true if the last jump has the size of `earlier_rad` and the opposite direction.
    [[nodiscard]] constexpr bool reverses_jump(double earlier_rad) const noexcept {
        return magnitude(jump_rad_) > 2 * jump_error_rad_ &&
               magnitude(jump_rad_ + earlier_rad) <= 2 * jump_error_rad_;
    }

    /// Returns true if the joint can have moved from the end of one run to the start of the next.
    [[nodiscard]] constexpr bool connects(const MotionRun& before, const MotionRun& run) const noexcept {
        const std::int64_t disturbed_ns = disturbed_ || lost() ? config_.max_age_ns : 0;
        if (comparison_.near(before.last().stamp_ns + disturbed_ns, run.first().stamp_ns)) {
            return comparison_.meets(before, run, longest_s(), ShareAtZero{*this, run.first()});
        }
        const double silence_s = seconds_between(before.last().stamp_ns, run.first().stamp_ns);
        return tolerance_.reaches(before.last(), run.first()) &&
               comparison_.reaches_after_silence(before, run.first()) &&
               (silence_s <= clock_s || comparison_.can_follow(before, run)); // an impact, a clock step
    }

    /// Returns true if a run still comes from the encoder whose readings are rejected. A small jump, or a
    /// clock step of a few milliseconds, does not restore its zero.
    [[nodiscard]] constexpr bool goes_on_from_refused(const MotionRun& run) const noexcept {
        const bool small_jump = comparison_.near(refused_.last().stamp_ns, run.first().stamp_ns) &&
                                tolerance_.reaches(refused_.last(), run.first());
        return small_jump || connects(refused_, run);
    }

    /// Returns true if a run begins where an encoder that was switched on begins.
    [[nodiscard]] constexpr bool begins_at_zero(const EncoderReading& first,
                                                const MotionLine& begin) const noexcept {
        const bool hidden = !time_known_ && !comparison_.comes_within(trusted_, first, clock_s);
        return zero_.explains(first, begin, trusted_.end_line(0, config_.period_ns).velocity,
                              hidden ? clock_s : 0);
    }

    /// Tries both of the first two readings of a run, because one may be late.
    [[nodiscard]] constexpr bool begins_at_zero(const MotionRun& run) const noexcept {
        return begins_at_zero(run.first(), run.begin_line(0, config_.period_ns)) ||
               begins_at_zero(run.first(), run.begin_line(1, config_.period_ns));
    }

    /// Returns true if an incremental encoder that restarted unseen can have counted to the run.
    [[nodiscard]] constexpr bool may_count_from_zero(const MotionRun& run) const noexcept {
        return !stood_at(run.first()) && !reverses_jump_before(run) &&
               zero_.may_explain(trusted_, run, time_known_ ? 0 : clock_s);
    }

    /// Returns the shortest silence of a board that restarts (s).
    [[nodiscard]] constexpr double fastest_boot_s() const noexcept {
        return std::max(0.01, 2 * seconds_between(0, config_.period_ns));
    }

    /// Returns true if a run after a silence begins at the device's zero, unless the joint was at rest there
    /// before.
    [[nodiscard]] constexpr bool restarted_at_zero(const MotionRun& run) const noexcept {
        const bool long_enough = !time_known_ || seconds_between(trusted_.last().stamp_ns,
                                                                 run.first().stamp_ns) >= fastest_boot_s();
        return long_enough && begins_at_zero(run) && !stood_at(run.first()) && !reverses_jump_before(run);
    }

    // Changed by MotionGate: NOLINTBEGIN(*-non-private-member-variables-in-classes)
    Config config_;                   ///< of the joint
    MotionTolerance tolerance_;       ///< of readings
    RunComparison comparison_;        ///< of runs
    ZeroWatch zero_;                  ///< readings that count from the zero
    AwayWatch away_;                  ///< readings that jumped away from the joint
    MotionRun trusted_;               ///< the positions of the joint
    MotionRun established_;           ///< trusted before them and for longer
    std::int64_t trial_end_ns_ = 0;   ///< end of the trial of `trusted_`
    std::int64_t jump_ns_ = 0;        ///< start of the last untrusted run
    double jump_rad_ = 0;             ///< distance from the readings before it; 0: after a silence
    double jump_before_rad_ = 0;      ///< jump of the run before
    std::int64_t jump_before_ns_ = 0; ///< start of that run
    double jump_error_rad_ = 0;       ///< largest error of `jump_rad_`
    UnfitReadings unfit_;             ///< since the last trusted one
    bool counts_from_zero_ = false;   ///< readings of unknown time began at the zero, far from the joint
    CandidateRun candidate_;          ///< of readings that qualify
    MotionRun refused_;               ///< does not connect; rejected while it continues
    bool expected_ = false;           ///< a run shortly before led to the start of the run
    bool suspected_ = false;          ///< the run may come from a frozen encoder
    bool disturbed_ = false;          ///< a jump has occurred since the last trusted reading
    bool interrupted_ = false;        ///< the device was not ready since the last trusted reading
    bool time_known_ = true;          ///< time since the last trusted reading is known
    bool refused_time_known_ = true;  ///< time since the last rejected reading is known
    bool zero_lost_ = false;          ///< the rejected readings began at the device's zero
    int lost_readings_ = 0;           ///< in all rejected runs since the joint was lost
    // NOLINTEND(*-non-private-member-variables-in-classes)
};

} // namespace dfdyn::hal
