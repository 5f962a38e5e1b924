// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/motion/encoder_reading.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn::hal {

/// Compares a joint's positions with the velocity that its device reports in the same frames. It finds what
/// no limit of the motion excludes: an encoder that freezes at rest, another scale or sign after a silence,
/// or a position that drifts.
///
/// Over windows of at most 0.6 rad and 2 s in one direction, the distance moved is compared with the integral
/// of the velocity. They contradict each other if they differ by more than a fifth of the distance by
/// velocity, a lag of 30 ms, 0.05 rad/s, 20 mrad and four counts together. A velocity that has not agreed
/// with the position over `known_rad` may be described wrongly, and is no evidence. A single jump is left to
/// the MotionGate. Positions that come without a velocity for 2 s are no longer contradicted, and a later
/// velocity must agree again. O(1).
class VelocityWitness {
  public:
    static constexpr double known_rad = 1; ///< over which the two must agree first

    /// Takes a value with a position. Returns true while position and velocity contradict each other. This
    /// ends when they agree over 0.05 rad, or when the device sends no velocity any more.
    constexpr bool contradicts(const JointValue& value) noexcept {
        velocity_ns_ = value.has_velocity ? value.stamp_ns : velocity_ns_;
        const bool ended = seconds_between(velocity_ns_, value.stamp_ns) > longest_window_s;
        if (ended) { // the device sends no velocity any more
            agreed_rad_ = 0;
            contradicted_ = false;
        }
        const double apart_s = seconds_between(last_.stamp_ns, value.stamp_ns);
        const bool follows =
            last_.has_velocity && value.has_velocity && apart_s > 0 && apart_s < longest_step_s;
        const bool turns = value.velocity * window_.expected_rad < 0; // also after a rest
        if (!follows || turns || !add(value, apart_s)) {
            window_ = {};
        } else if (differs(value.step_rad)) {
            contradicted_ = is_known();
            disagree();
            window_ = {};
        } else if (window_.travelled_rad >= enough_rad && agrees(value.step_rad)) {
            agreed_rad_ = std::min(agreed_rad_ + window_.travelled_rad, known_rad);
            contradicted_ = false;
            window_ = {};
        } else if (ends_undecided()) {
            if (!agrees(value.step_rad)) {
                disagree();
            }
            window_ = {};
        }
        last_ = value;
        return contradicted_;
    }

  private:
    static constexpr double longest_step_s = 0.1, longest_window_s = 2, longest_rest_s = 0.2;
    static constexpr double enough_rad = 0.05; ///< by velocity, to agree
    static constexpr double longest_window_rad = 0.6;
    static constexpr double share_of_fault = 0.2, share_of_agreement = 0.15;
    static constexpr double lag_s = 0.03; ///< of the device's velocity
    static constexpr double slow = 0.05;  ///< rad/s, resolution of velocities
    static constexpr double rounding_rad = 0.02;

    /// Sums since the last comparison.
    struct Window {
        double time_s = 0;
        double moved_rad = 0;     ///< by position
        double expected_rad = 0;  ///< by velocity
        double travelled_rad = 0; ///< by velocity, without sign
        double fastest = 0;       ///< rad/s
    };

    /// Adds a step; returns false for a jump.
    constexpr bool add(const JointValue& value, double apart_s) noexcept {
        EncoderReading moved{.position_rad = value.position_rad - last_.position_rad,
                             .wrap_rad = value.wrap_rad};
        unwrap_near(moved, 0);
        const double moved_rad = moved.position_rad;
        const double expected_rad = 0.5 * (value.velocity + last_.velocity) * apart_s;
        const double slower = std::min(magnitude(value.velocity), magnitude(last_.velocity));
        window_.time_s += apart_s;
        window_.moved_rad += moved_rad;
        window_.expected_rad += expected_rad;
        window_.travelled_rad += magnitude(expected_rad);
        window_.fastest = std::max({window_.fastest, magnitude(value.velocity), magnitude(last_.velocity)});
        return magnitude(moved_rad - expected_rad) <= rounding_rad + 1.5 * slower * apart_s;
    }

    /// Returns true if the velocity is evidence. It remains so.
    [[nodiscard]] constexpr bool is_known() const noexcept { return agreed_rad_ >= known_rad; }

    constexpr void disagree() noexcept { agreed_rad_ = is_known() ? agreed_rad_ : 0; }

    [[nodiscard]] constexpr bool rests() const noexcept {
        return window_.travelled_rad < rounding_rad / 2 && magnitude(window_.moved_rad) < rounding_rad / 2;
    }

    [[nodiscard]] constexpr double error_rad() const noexcept {
        return magnitude(window_.moved_rad - window_.expected_rad);
    }

    /// Returns true if no device's velocity differs so much from the motion.
    [[nodiscard]] constexpr bool differs(double step_rad) const noexcept {
        return error_rad() > share_of_fault * window_.travelled_rad + lag_s * window_.fastest +
                                 slow * window_.time_s + rounding_rad + 4 * step_rad;
    }

    [[nodiscard]] constexpr bool agrees(double step_rad) const noexcept {
        return error_rad() <= share_of_agreement * window_.travelled_rad + rounding_rad / 4 + 2 * step_rad;
    }

    [[nodiscard]] constexpr bool ends_undecided() const noexcept {
        return window_.travelled_rad >= longest_window_rad ||
               window_.time_s >= (rests() ? longest_rest_s : longest_window_s);
    }

    JointValue last_;
    std::int64_t velocity_ns_ = 0; ///< stamp of the last value with a velocity
    Window window_;
    double agreed_rad_ = 0; ///< by velocity, in successive windows that agreed; at most `known_rad`
    bool contradicted_ = false;
};

} // namespace dfdyn::hal
