// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn {

/// One joint under proportional-derivative feedback, for a stability analysis.
template <class Scalar>
struct JointLoop {
    Scalar inertia;       ///< of the arm at this joint, kg·m²; > 0
    Scalar position_gain; ///< N·m/rad; > 0
    Scalar velocity_gain; ///< N·m·s/rad; ≥ 0
    Scalar delay_s;       ///< from a position to the resulting torque, including half a tick of hold; ≥ 0
    Scalar velocity_delay_s; ///< additional delay of the velocity: half the length of its window; ≥ 0
};

/// Phase margin of such a joint with a `DisturbanceObserver`. The open loop is
///
///     L(s) = e^(-s delay) [P (1 + b/s) + (D (1 + b/s) + b J) s e^(-s velocity delay)] / (J' s²)
///
/// where P and D are the gains, b and J the observer's bandwidth and inertia, and J' the true inertia. A
/// textbook phase margin (K. J. Åström, R. M. Murray, "Feedback Systems", 2008, ch. 9).
template <class Scalar>
class LoopMargin {
  public:
    /// `observer_inertia`: inertia that the observer uses, kg·m²; ≥ 0.
    constexpr LoopMargin(const JointLoop<Scalar>& loop, Scalar observer_inertia) noexcept
        : loop_(loop), observer_inertia_(observer_inertia) {}

    /// Returns the phase margin in rad, at the highest frequency where |L| = 1; a negative margin means
    /// instability. `bandwidth`: of the observer, rad/s, ≥ 0. Cost: about 80 evaluations of L.
    [[nodiscard]] Scalar phase(Scalar bandwidth) const noexcept {
        Scalar low = lowest;
        Scalar high = highest;
        // Bisection on a logarithmic scale for the last crossover of |L| = 1.
        for (int i = 0; i < steps; ++i) {
            using std::sqrt;
            const Scalar middle = sqrt(low * high);
            (at(bandwidth, middle).square > 1 ? low : high) = middle;
        }
        return at(bandwidth, high).phase;
    }

    /// Returns the largest bandwidth, rad/s, at most `most` > 0, such that every smaller bandwidth has a
    /// phase margin of at least `margin` (rad, below π / 2); 0 if none has. Cost: about 5000 evaluations of
    /// L, so call it when the program starts.
    [[nodiscard]] Scalar largest_bandwidth(Scalar margin, Scalar most) const noexcept {
        Scalar low = 0;
        Scalar high = most * least_share;
        while (high < most && phase(high) >= margin) {
            low = high;
            high = std::min(high * growth, most);
        }
        if (phase(high) >= margin) {
            return high;
        }
        for (int i = 0; i < bisections; ++i) {
            const Scalar middle = (low + high) / 2;
            (phase(middle) >= margin ? low : high) = middle;
        }
        return low;
    }

  private:
    static constexpr Scalar lowest = Scalar(1e-2); ///< rad/s
    static constexpr Scalar highest = Scalar(1e5); ///< rad/s
    static constexpr int steps = 80;
    static constexpr int bisections = 24;
    static constexpr Scalar least_share = Scalar(1e-3); ///< smallest bandwidth tried, relative to the largest
    static constexpr Scalar growth = Scalar(1.25);

    struct Point {
        Scalar square; ///< |L|²
        Scalar phase;  ///< of -L, rad: the phase margin where |L| = 1
    };

    /// Evaluates L at the angular frequency `w`. The sign accounts for the -1 of the double integrator.
    [[nodiscard]] Point at(Scalar bandwidth, Scalar w) const noexcept {
        using std::atan2;
        using std::cos;
        using std::sin;
        const Scalar b = bandwidth;
        const Scalar rate = loop_.velocity_gain + b * observer_inertia_;
        const Scalar lag = w * loop_.velocity_delay_s;
        // P (1 + b/s) + (D b + rate s) e^(-s velocity delay), with s = i w
        const Scalar real = loop_.position_gain + loop_.velocity_gain * b * cos(lag) + rate * w * sin(lag);
        const Scalar imaginary =
            -loop_.position_gain * b / w - loop_.velocity_gain * b * sin(lag) + rate * w * cos(lag);
        const Scalar plant = loop_.inertia * w * w;
        if (lag + w * loop_.delay_s > std::numbers::pi_v<Scalar>) { // atan2 wraps beyond half a turn
            return {(real * real + imaginary * imaginary) / (plant * plant), -std::numbers::pi_v<Scalar>};
        }
        return {(real * real + imaginary * imaginary) / (plant * plant),
                atan2(imaginary, real) - w * loop_.delay_s};
    }

    JointLoop<Scalar> loop_;
    Scalar observer_inertia_;
};

} // namespace dfdyn
