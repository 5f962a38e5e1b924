// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Decides from time stamps whether samples were lost between two of them.
///
/// A single step cannot distinguish jitter from a loss: two consecutive stamps that are each half a period
/// early or late are up to two periods apart. Therefore a phase-locked loop follows the sample grid. The grid
/// is the sender's regular clock; the stamps are its noisy readings. The loop is a Kalman filter with two
/// states, phase and period; all quantities are in nominal sample periods. The period may deviate from the
/// nominal one by one eighth.
///
/// Let e be the delay of a stamp with respect to its position on the grid, and f the excess of its step over
/// one period. Samples were lost if
///  - e > 1/2 + max(1/8, 4 p), where p is the standard error of the predicted position: the root mean square
///    jitter times the filter's relative error, which falls from 1 at the first sample of a grid to 0.09; or
///  - f > 5/8 and f - 5/8 > 2 r, where r is the root mean square of recent f; or
///  - the step is longer than 16 periods.
///
/// A sender that waits a fixed time after each sample has no grid. While the mean square of e is more than
/// twice that of f, the first condition is replaced by f > 1/2.
///
/// Uniform jitter of up to ± half a period is therefore not mistaken for a loss: e stays below 1/2 + p, and f
/// below 5/8 + 2 r. A lost sample adds one period to e and f. It is detected if the next stamp is early by
/// less than 3/8 of a period and p is below 1/32; without jitter it is detected from the second sample on.
/// Beyond these limits a late stamp and an early stamp after a loss look the same, and the rule assumes
/// jitter. An early stamp is never a loss. After a loss the phase is initialised again; after a step longer
/// than 16 periods the period is too.
class SampleClock {
  public:
    /// Multiply-adds per sample; the square root and each division count as 16.
    static constexpr std::int64_t cost = 80;

    /// Processes one stamp and returns true if samples were lost before it. `step_ns`: time since the last
    /// sample (ns), > 0. `period_ns`: nominal sample period (ns), > 0, constant between two restarts.
    bool lost_before(std::uint64_t step_ns, std::int64_t period_ns) noexcept {
        const float step = static_cast<float>(step_ns) / static_cast<float>(period_ns);
        if (step > longest_step) {
            restart();
            return true;
        }
        const Covariance predicted{covariance_.phase + 2 * covariance_.both + covariance_.period,
                                   covariance_.both + covariance_.period, covariance_.period};
        const float from_last = step - period_;
        const float from_grid = from_last + late_;
        if (lost(from_grid, from_last, predicted.phase)) {
            late_ = 0;
            covariance_ = {1, 0, covariance_.period};
            return true;
        }
        correct(predicted, std::max(from_grid, earliest), from_last);
        return false;
    }

    /// Forgets the grid; the next sample starts a new one.
    constexpr void restart() noexcept { *this = {}; }

    /// Returns the estimated sample period relative to the nominal one, in [7/8, 9/8].
    [[nodiscard]] constexpr float relative_period() const noexcept { return period_; }

  private:
    /// Covariance of the filter's states, relative to the variance of the jitter.
    struct Covariance {
        float phase, both, period;
    };
    static constexpr float longest_step = 16;
    static constexpr float earliest = -2;
    static constexpr float memory = 1.0F / 32;         ///< forgetting of the mean squares, per sample
    static constexpr float period_variance = 0.02F;    ///< initial value
    static constexpr float period_random_walk = 1e-9F; ///< per sample; sets the steady-state gain, 0.009
    static constexpr float jitter_square = 0.011F;     ///< initial value; the first limit is then 0.92
    static constexpr float floor = 1e-12F;             ///< avoids denormal numbers

    /// Applies the rule. `from_grid`, `from_last`: errors of the two predictions (e and f); `phase_variance`:
    /// p² relative to the mean square jitter.
    [[nodiscard]] bool lost(float from_grid, float from_last, float phase_variance) const noexcept {
        const float sure = from_last - 0.625F;
        if (sure > 0 && sure * sure > 4 * last_square_) {
            return true;
        }
        if (grid_square_ > 2 * last_square_) {
            return from_last > 0.5F * period_;
        }
        const float margin = std::max(0.125F, 4 * std::sqrt(grid_square_ * phase_variance));
        return from_grid > (0.5F + margin) * period_;
    }

    void correct(const Covariance& predicted, float from_grid, float from_last) noexcept {
        const float left = 1 / (predicted.phase + 1);
        const float phase_gain = predicted.phase * left;
        const float period_gain = predicted.both * left;
        covariance_ = {phase_gain, predicted.both * left,
                       predicted.period - period_gain * predicted.both + period_random_walk};
        late_ = from_grid * left;
        late_ = std::abs(late_) < floor ? 0.0F : late_;
        period_ = std::clamp(period_ + period_gain * from_grid, 0.875F, 1.125F);
        grid_square_ += memory * (from_grid * from_grid * left - grid_square_) + floor;
        last_square_ += memory * (from_last * from_last - last_square_) + floor;
    }

    float late_ = 0; ///< delay of the last stamp on the grid
    float period_ = 1;
    Covariance covariance_{1, 0, period_variance};
    float grid_square_ = jitter_square; ///< mean square error of the grid's predictions
    float last_square_ = 2 * jitter_square;
};

} // namespace dfdyn
