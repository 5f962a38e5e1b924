// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/motion/run_comparison.hpp"

#include <cstdint>

namespace dfdyn::hal {

/// Collects untrusted readings into a run of consistent readings. One inconsistent reading does not end the
/// run; three that are consistent with each other do. O(1).
class CandidateRun {
  public:
    /// Relation of a reading to the run.
    enum class Step : std::uint8_t { continues, begins, is_off };

    /// Takes a reading and returns its relation to the run.
    constexpr Step take(const EncoderReading& reading, const RunComparison& comparison,
                        const MotionTolerance& tolerance) noexcept {
        if (comparison.continues(run_, reading)) {
            other_ = {};
            run_.extend(reading, tolerance);
            return Step::continues;
        }
        const bool recent = !run_.empty() && comparison.near(run_.last().stamp_ns, reading.stamp_ns);
        const bool other_goes_on = comparison.continues(other_, reading);
        if (recent && !(other_goes_on && other_.readings() + other_.zeros() >= min_other_readings)) {
            other_ = other_goes_on ? other_ : MotionRun();
            other_.extend(reading, tolerance);
            return Step::is_off;
        }
        const EncoderReading& first = other_goes_on ? other_.first() : reading; // of the new run
        const bool follows = !run_.empty() && comparison.near(run_.last().stamp_ns, first.stamp_ns);
        const bool repeats = run_.first().position_rad == run_.last().position_rad; // no evidence
        const bool apart = follows && !repeats && !tolerance.reaches(run_.last(), first);
        contradicted_ = contradicted_ || (apart && run_.readings() + run_.zeros() >= min_run_readings);
        before_ = run_.empty() ? before_ : run_;
        run_ = other_goes_on ? other_ : MotionRun();
        other_ = {};
        run_.extend(reading, tolerance);
        contradicted_ = contradicted_ || (follows && !repeats && jumps(comparison, tolerance));
        return Step::begins;
    }

    /// Returns true if at least two consistent readings contradict this one.
    [[nodiscard]] constexpr bool disputes(const EncoderReading& reading,
                                          const RunComparison& comparison) const noexcept {
        return run_.readings() >= 2 && !comparison.continues(run_, reading);
    }

    /// Returns true if no other reading came shortly before this one.
    [[nodiscard]] constexpr bool silent_before(const EncoderReading& reading,
                                               const RunComparison& comparison) const noexcept {
        const auto silent = [&](const MotionRun& run) {
            return run.empty() || !comparison.near(run.last().stamp_ns, reading.stamp_ns);
        };
        return silent(run_) && silent(other_);
    }

    /// Forgets the run, but keeps the flag `contradicted`.
    constexpr void interrupt() noexcept {
        before_ = run_.empty() ? before_ : run_;
        run_ = {};
    }

    /// Sets the flag `contradicted` if the device contradicts itself.
    constexpr void contradict(bool contradicts) noexcept { contradicted_ = contradicted_ || contradicts; }

    /// Forgets everything, because the joint is trusted.
    constexpr void clear() noexcept { *this = {}; }

    /// Returns the current run.
    [[nodiscard]] constexpr const MotionRun& run() const noexcept { return run_; }

    /// Returns the readings that are consistent with each other but not with the run.
    [[nodiscard]] constexpr const MotionRun& other() const noexcept { return other_; }

    /// Returns the run before the current one.
    [[nodiscard]] constexpr const MotionRun& before() const noexcept { return before_; }

    /// Returns true if the readings changed from one run to another without a silence.
    [[nodiscard]] constexpr bool contradicted() const noexcept { return contradicted_; }

  private:
    static constexpr int min_other_readings = 2; ///< of the other run, before it replaces the run
    static constexpr int min_run_readings = 2;   ///< of a contradicted run; one may be wrong

    /// Returns true if no motion connects the run before with this one.
    [[nodiscard]] constexpr bool jumps(const RunComparison& comparison,
                                       const MotionTolerance& tolerance) const noexcept {
        constexpr int min_readings = 3; // for an estimate of the motion
        constexpr double periods = 1.5;
        return tolerance.period_ns > 0 && before_.readings() >= min_readings &&
               run_.readings() >= min_readings &&
               !comparison.meets(before_, run_, periods * seconds_between(0, tolerance.period_ns),
                                 [](const MotionLine&) { return 1.0; });
    }

    MotionRun run_;
    MotionRun before_; ///< last run that ended
    MotionRun other_;  ///< readings that are not consistent with the run
    bool contradicted_ = false;
};

} // namespace dfdyn::hal
