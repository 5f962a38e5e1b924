// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace dfdyn {

/// Distinguishes a push from a change of the arm by the time for which measurements contradict the model.
///
/// The contradiction of a sample is its normalised innovation squared divided by a limit. The limit is the
/// model's, times a level that adapts to this arm.
///  - Up to 1 the sample is learned unchanged.
///  - Up to `rejection` it is learned with contradiction⁴ times the noise variance. The further beyond the
///    limit, the less it changes the model: a redescending influence function in three parts (F. R. Hampel,
///    "The influence curve and its role in robust estimation", 1974).
///  - Beyond `rejection` it is refused.
///
/// From a sample beyond `alarm` until the count below has returned to 0, the limit is reduced to a third
/// (`ordinary`). Otherwise the end of a push, which is below the full limit, would be learned.
///
/// A count, in samples, rises with each contradiction beyond `ordinary` and falls with each other sample. A
/// push ends before the count has reached the patience. Beyond the patience the arm is assumed to have
/// changed: `take_change` reports it once. From then on all samples are learned unchanged until plausible
/// samples outnumber the others by `settling` patiences. A moving arm that has changed has plausible samples
/// at each reversal. They delay the decision by their number, but do not reset the count to 0.
///
/// The level is a running quantile by stochastic approximation, and at least 1. Only samples that are learned
/// unchanged after a change raise it, so that a model that never fits is not reported repeatedly. The
/// exponent, `rejection` and `settling` were chosen on a simulated two-link arm, motions No3 to No6 of a
/// measured arm and runs 00 to 03 of a servo. For `alarm` a pushed motion No7 was also used.
template <class Scalar>
class InnovationGate {
  public:
    /// Contradiction beyond which a sample is evidence of a change. The calibrated limit is three times the
    /// value that 0.1 % of the samples of an unchanged arm exceed.
    static constexpr double ordinary = 1.0 / 3;
    /// Contradiction beyond which a sample is attributed to a push.
    static constexpr double alarm = 3;
    /// Contradiction beyond which a sample is refused.
    static constexpr double rejection = 10;
    /// Net number of plausible samples that end a change, in patiences.
    static constexpr std::int64_t settling = 4;

    /// `limit` > 0; any other value, including NaN, makes every sample a contradiction. `patience`: samples,
    /// any number; with 0 or less every sample is learned unchanged.
    constexpr InnovationGate(Scalar limit, std::int32_t patience) noexcept
        : limit_(limit), patience_(patience), rise_(1 + 2 / Scalar(std::max<std::int32_t>(patience, 2))),
          fall_(std::min<Scalar>(1 - Scalar(0.002) / Scalar(std::max<std::int32_t>(patience, 2)),
                                 1 - std::numeric_limits<Scalar>::epsilon())) {}

    /// Starts a new motion. Forgets contradictions that are no change yet. Keeps the level and a change that
    /// has not settled, and an unreported one as if it had just been detected: what the last motion found
    /// also applies to the samples of this one.
    constexpr void restart() noexcept {
        if (change_pending_) {
            report_change();
        } else if (!changed_) {
            count_ = 0;
        }
        alarmed_ = false;
    }

    /// Checks one measured sample by its normalised innovation squared, ≥ 0 and not NaN. Returns the noise
    /// variance to learn it with, in units of the output's noise variance (≥ 1), or 0 to refuse it.
    [[nodiscard]] constexpr Scalar judge(Scalar normalised_innovation_squared) noexcept {
        const Scalar limit = limit_ * level_;
        const Scalar contradiction =
            limit > 0 ? normalised_innovation_squared / limit : std::numeric_limits<Scalar>::max();
        const bool implausible = contradiction > Scalar(ordinary);
        count(implausible);
        level_ = std::clamp(level_ * (changed_ && implausible ? rise_ : fall_), Scalar(1), Scalar(highest));
        alarmed_ = contradiction > Scalar(alarm) || (alarmed_ && count_ > 0);
        const Scalar excess = contradiction * (alarmed_ ? Scalar(1 / ordinary) : Scalar(1));
        const Scalar square = excess * excess;
        const Scalar fourth = square * square;
        if (changed_ || patience_ <= 0 || excess <= 1) {
            return 1;
        }
        return contradiction > Scalar(rejection) ? Scalar(0) : fourth;
    }

    /// Returns whether a change of the arm was detected and `take_change` has not reported it yet.
    [[nodiscard]] constexpr bool change_pending() const noexcept { return change_pending_; }

    /// Registers a change of the arm that was detected elsewhere, as if the gate had detected it.
    constexpr void report_change() noexcept {
        change_pending_ = true;
        changed_ = patience_ > 0;
        count_ = changed_ ? settling * patience_ : count_;
    }

    /// Returns true once after each detected change of the arm.
    constexpr bool take_change() noexcept {
        const bool pending = change_pending_;
        change_pending_ = false;
        return pending;
    }

    static constexpr int cost = 6; ///< multiply-adds of `judge`

  private:
    static constexpr double highest = 1000; ///< maximum level: a model this far off must be trained again

    constexpr void count(bool implausible) noexcept {
        if (!implausible) {
            count_ -= count_ > 0 ? 1 : 0;
            changed_ = changed_ && count_ > 0;
        } else if (count_ < (changed_ ? settling : 1) * patience_) {
            ++count_;
        } else if (patience_ > 0 && !changed_) {
            report_change();
        }
    }

    Scalar limit_;
    std::int32_t patience_;
    Scalar rise_, fall_; ///< factors on the level per sample
    Scalar level_ = 1;
    /// 0 … patience, or up to `settling` patiences after a change.
    std::int64_t count_ = 0;
    /// A sample exceeded `alarm`, and the count has not been 0 since.
    bool alarmed_ = false;
    bool changed_ = false;
    bool change_pending_ = false;
};

} // namespace dfdyn
