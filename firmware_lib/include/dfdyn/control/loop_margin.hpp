// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn {

/// One joint under proportional and derivative feedback, as far as stability needs it.
template <class Scalar>
struct JointLoop {
    Scalar inertia;       ///< of the arm at this joint, kg·m²; > 0
    Scalar position_gain; ///< N·m/rad; > 0
    Scalar velocity_gain; ///< N·m·s/rad; ≥ 0
    Scalar delay_s;       ///< from a position to the torque that answers it, half a tick of holding included
    Scalar velocity_delay_s; ///< beyond that, of the velocity: half the length of its window
};

/// How far such a joint with a `DisturbanceObserver` is from oscillation, by its open loop
///
///     L(s) = e^(-s delay) [P (1 + b/s) + (D (1 + b/s) + b J) s e^(-s velocity delay)] / (J' s²)
///
/// with the gains P and D, the observer's bandwidth b and inertia J, and the true inertia J'. A textbook
/// phase margin (K. J. Åström, R. M. Murray, "Feedback Systems", 2008, ch. 9).
template <class Scalar>
class LoopMargin {
  public:
    /// `observer_inertia`: the one given to the observer, kg·m²; ≥ 0.
    constexpr LoopMargin(const JointLoop<Scalar>& loop, Scalar observer_inertia) noexcept
        : loop_(loop), observer_inertia_(observer_inertia) {}

    /// rad, at the highest frequency where |L| is 1; negative: unstable. `bandwidth`: rad/s, ≥ 0. About 80
    /// evaluations of L.
    [[nodiscard]] Scalar phase(Scalar bandwidth) const noexcept {
        Scalar low = lowest;
        Scalar high = highest;
        for (int i = 0; i < steps; ++i) { // on a logarithmic scale; |L| falls below 1 once, at the end
            using std::sqrt;
            const Scalar middle = sqrt(low * high);
            (at(bandwidth, middle).square > 1 ? low : high) = middle;
        }
        return at(bandwidth, high).phase;
    }

    /// The largest bandwidth up to `most` below which every one leaves a margin of `margin` rad, rad/s; 0 if
    /// none does. About 5000 evaluations of L: for the start of a program.
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
    static constexpr Scalar least_share = Scalar(1e-3); ///< of the largest bandwidth: where the search begins
    static constexpr Scalar growth = Scalar(1.25);

    struct Point {
        Scalar square; ///< |L|²
        Scalar phase;  ///< of -L: the margin where |L| is 1, rad
    };

    /// L at the angular frequency `w`. Its numerator over s, then the double integrator's -1 by the sign.
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
        if (lag + w * loop_.delay_s >
            std::numbers::pi_v<Scalar>) { // beyond it the angle is that of another turn
            return {(real * real + imaginary * imaginary) / (plant * plant), -std::numbers::pi_v<Scalar>};
        }
        return {(real * real + imaginary * imaginary) / (plant * plant),
                atan2(imaginary, real) - w * loop_.delay_s};
    }

    JointLoop<Scalar> loop_;
    Scalar observer_inertia_;
};

} // namespace dfdyn
