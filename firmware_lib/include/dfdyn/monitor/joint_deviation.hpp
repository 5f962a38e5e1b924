// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"
#include "dfdyn/monitor/friction_hysteresis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Class of a joint's motion, on which its friction depends. `changing`: the joint started, stopped or
/// reversed within `JointDeviation::change_s`, is about to stop, or moves slowly.
enum class JointMotion : std::uint8_t { standing, changing, moving };
inline constexpr int joint_motion_count = 3;

/// Properties of one joint's deviation (see JointDeviation) without contact, in the output's unit. `dfdyn
/// train` measures them.
template <class Scalar>
struct ContactLimits {
    Scalar limit[joint_motion_count]; ///< in each motion, smallest deviation of a contact at this joint alone
    Scalar usual;                     ///< median of the magnitude while the joint moves, >= 0
    Scalar relative;                  ///< added limit per recent change of the prediction, >= 0
    Scalar speed;                     ///< rad/s, largest usual, > 0
    Scalar acceleration;              ///< rad/s², largest usual, low-pass filtered, > 0
    Scalar standard_deviation = 0;    ///< of a prediction, usual; 0: unknown
    Scalar hysteresis = 0;            ///< dry friction in which FrictionHysteresis is measured, >= 0
};

/// Deviation of one joint's torque or current from its prediction, and the limit for it.
///
/// The deviation is the error (measured - predicted) after a low-pass filter with two poles, minus a baseline
/// that follows the error with the time constant `baseline_s`. Slow errors, for example of weight,
/// temperature or payload, are therefore not contacts. Friction jumps when a joint starts, stops or reverses.
/// For `change_s` after that, the baseline is an interval: from its last value to zero, the error of an
/// accurate model in motion. The baseline follows at most `clip` limits. During a contact it is also an
/// interval, from its value before the contact to its present value. The return of the error is then no
/// second contact. `hysteresis` times the range of FrictionHysteresis is added to the interval.
///
/// The limit grows in three ways:
/// - A model's error is partly proportional to its prediction. `relative` times the change of the prediction
///   within `baseline_s` is added to the limit of the motion, as the root of the sum of squares.
/// - Where deviations are larger than in training, the limit grows in proportion to their median while the
///   joint moves, at most by `most_growth`. Contacts change a median little unless they fill half of the
///   time. Elsewhere a median varies too much from posture to posture.
/// - Where the model knows less than in training, for example in a new posture, the limit grows in proportion
///   to the prediction's standard deviation, at most by `most_doubt`, with the time constant `baseline_s`.
///   The median is relative to this.
template <class Scalar>
class JointDeviation {
  public:
    static constexpr Scalar filter_s = Scalar(0.02);          ///< time constant of each pole of the error, s
    static constexpr Scalar velocity_filter_s = Scalar(0.01); ///< time constant of the velocity's pole, s
    static constexpr Scalar baseline_s = Scalar(0.7);         ///< time constant of the baseline, s
    static constexpr Scalar range_s = Scalar(0.3); ///< time constant of the growth beyond the training, s
    /// A joint whose deceleration brings it to rest within this time is about to stop, s.
    static constexpr Scalar stop_s = Scalar(0.1);
    static constexpr Scalar change_s = Scalar(0.2);     ///< duration of a change of the motion, s
    static constexpr Scalar clip = Scalar(0.6);         ///< deviation that the baseline follows, in limits
    static constexpr Scalar contact_clip = Scalar(0.1); ///< the same during a contact
    static constexpr Scalar median_s = 20;              ///< time constant of the change of a median, s
    static constexpr Scalar most_growth = 4;      ///< largest factor by which a limit grows with its median
    static constexpr Scalar most_doubt = 4;       ///< same, with the standard deviation of the prediction
    static constexpr Scalar still = Scalar(0.02); ///< rad/s, largest speed of a stationary joint
    /// Speed below which dry friction still rises towards stiction (Stribeck effect), rad/s.
    static constexpr Scalar slow = Scalar(0.08);

    /// Shares of the present values in the filters of all joints, for one tick.
    struct Steps {
        /// Computes them for a period.
        explicit Steps(Scalar period_s) noexcept
            : dt(period_s), filter(1 - std::exp(-dt / filter_s)),
              velocity(1 - std::exp(-dt / velocity_filter_s)), baseline(1 - std::exp(-dt / baseline_s)),
              range(1 - std::exp(-dt / range_s)), median(dt / median_s),
              lag(1 - std::exp(-dt / FrictionHysteresis<Scalar>::lag_s)) {}
        Scalar dt;       ///< s
        Scalar filter;   ///< of the error, the prediction and the acceleration
        Scalar velocity; ///< of the velocity
        Scalar baseline; ///< of the baseline
        Scalar range;    ///< of the growth beyond the training
        Scalar median;   ///< relative change of a median
        Scalar lag;      ///< of the velocity in FrictionHysteresis
    };

    /// Sets the median to that of the training.
    void reset(const ContactLimits<Scalar>& limits) noexcept { usual_ = limits.usual; }

    /// Starts at a position (rad) with an error and a prediction (the output's unit). Keeps the median.
    void begin(Scalar position, Scalar error, Scalar prediction) noexcept {
        position_ = position;
        velocity_ = earlier_velocity_ = acceleration_ = 0;
        first_prediction_pole_ = second_prediction_pole_ = earlier_prediction_ = prediction;
        first_pole_ = second_pole_ = low_ = high_ = error;
        hysteresis_.begin();
        deviation_ = share_ = 0;
        doubt_ = 1;
        direction_ = 0;
        since_change_s_ = change_s;
        motion_ = JointMotion::standing;
    }

    /// Updates the motion from a position (rad). Returns the larger of speed and acceleration, each relative
    /// to its largest usual value.
    Scalar follow_motion(Scalar position, const ContactLimits<Scalar>& limits, const Steps& steps) noexcept {
        const Scalar displacement = position - position_;
        velocity_ += steps.velocity * (displacement / steps.dt - velocity_);
        hysteresis_.follow(displacement, std::clamp(velocity_ / slow, Scalar(-1), Scalar(1)), steps.lag,
                           steps.filter);
        position_ = position;
        earlier_velocity_ += steps.filter * (velocity_ - earlier_velocity_);
        const Scalar present = (velocity_ - earlier_velocity_) / filter_s;
        acceleration_ += steps.filter * (present - acceleration_);
        return std::max(speed() / limits.speed, acceleration() / limits.acceleration);
    }

    /// Updates the factor on the limit for a standard deviation of the prediction (the output's unit). It
    /// approaches 1 for an unknown one. It is slow, because a push accelerates the joint, which raises the
    /// standard deviation.
    void follow_doubt(Scalar standard_deviation, const ContactLimits<Scalar>& limits,
                      const Steps& steps) noexcept {
        const Scalar usual = limits.standard_deviation;
        const Scalar ratio = usual > 0 ? standard_deviation / usual : Scalar(1);
        const Scalar present = std::max(Scalar(1), std::min(ratio, most_doubt)); // NaN: 1
        doubt_ += steps.baseline * (present - doubt_);
    }

    /// Updates the deviation and the baseline from an error and a prediction (the output's unit). `range`:
    /// factor on the limit, >= 1. Returns |deviation| / limit, at most `largest_share`.
    Scalar follow(Scalar error, Scalar prediction, const ContactLimits<Scalar>& limits, Scalar range,
                  bool contact, const Steps& steps) noexcept {
        first_pole_ += steps.filter * (error - first_pole_);
        second_pole_ += steps.filter * (first_pole_ - second_pole_);
        first_prediction_pole_ += steps.filter * (prediction - first_prediction_pole_);
        second_prediction_pole_ += steps.filter * (first_prediction_pole_ - second_prediction_pole_);
        earlier_prediction_ += steps.baseline * (second_prediction_pole_ - earlier_prediction_);
        classify(steps.dt);
        const Scalar friction = limits.hysteresis;
        deviation_ = second_pole_ - std::clamp(second_pole_, low_ + friction * hysteresis_.low(),
                                               high_ + friction * hysteresis_.high());
        const Scalar limit = range * doubt_ * limit_from(limits);
        follow_baseline(limit, friction, contact, steps);
        if (!contact && motion_ == JointMotion::moving) {
            follow_usual(steps);
        }
        share_ = std::min(std::abs(deviation_) / limit, largest_share);
        return share_;
    }

    /// Ends a contact: extends the baseline to the present error.
    void end() noexcept {
        low_ = std::min(low_, second_pole_);
        high_ = std::max(high_, second_pole_);
    }

    /// Takes the present error as the baseline.
    void accept() noexcept { low_ = high_ = second_pole_; }

    /// Returns the deviation in this tick, in the output's unit.
    [[nodiscard]] Scalar deviation() const noexcept { return deviation_; }
    /// Returns the factor by which the limit grows with the prediction's standard deviation, >= 1.
    [[nodiscard]] Scalar doubt() const noexcept { return doubt_; }
    /// Returns |deviation| / limit in this tick.
    [[nodiscard]] Scalar share() const noexcept { return share_; }
    /// Returns the change of the prediction within `baseline_s`, in the output's unit.
    [[nodiscard]] Scalar predicted_change() const noexcept {
        return second_prediction_pole_ - earlier_prediction_;
    }
    /// Returns the speed in rad/s, low-pass filtered.
    [[nodiscard]] Scalar speed() const noexcept { return std::abs(velocity_); }
    /// Returns the magnitude of the acceleration in rad/s², low-pass filtered.
    [[nodiscard]] Scalar acceleration() const noexcept { return std::abs(acceleration_); }
    /// Returns the motion in this tick.
    [[nodiscard]] JointMotion motion() const noexcept { return motion_; }
    /// Returns the range of the error that hysteresis explains, in units of the friction.
    [[nodiscard]] const FrictionHysteresis<Scalar>& hysteresis() const noexcept { return hysteresis_; }

  private:
    void classify(Scalar dt) noexcept {
        const int direction = std::abs(velocity_) < still ? 0 : (velocity_ > 0 ? 1 : -1);
        since_change_s_ = std::min(since_change_s_ + dt, change_s);
        if (direction != direction_ || (direction != 0 && stops_soon())) {
            low_ = std::min(low_, Scalar(0));
            high_ = std::max(high_, Scalar(0));
            direction_ = direction;
            since_change_s_ = 0;
        }
        const bool crawling = direction != 0 && std::abs(velocity_) < slow;
        if (changed() || crawling) {
            motion_ = JointMotion::changing;
            return;
        }
        motion_ = direction == 0 ? JointMotion::standing : JointMotion::moving;
    }

    /// Returns whether the joint started, stopped or reversed within `change_s`.
    [[nodiscard]] bool changed() const noexcept { return since_change_s_ < change_s; }

    /// Returns whether the present deceleration brings the joint to rest within `stop_s`.
    [[nodiscard]] bool stops_soon() const noexcept {
        const Scalar deceleration = (earlier_velocity_ - velocity_) / filter_s;
        return velocity_ * (deceleration * stop_s - velocity_) > 0;
    }

    void follow_baseline(Scalar limit, Scalar friction, bool contact, const Steps& steps) noexcept {
        const Scalar most = (contact ? contact_clip : clip) * limit;
        const Scalar step = steps.baseline * std::clamp(deviation_, -most, most);
        if (changed() || contact) {
            low_ += std::min(step, Scalar(0));
            high_ += std::max(step, Scalar(0));
        } else {
            approach(step, friction, steps.baseline);
        }
    }

    /// Moves the baseline towards the error: the edge that it exceeds by `step`, the other edge by `share` of
    /// its distance.
    void approach(Scalar step, Scalar friction, Scalar share) noexcept {
        const Scalar low = low_ + share * (unexplained_from(low_, friction) - low_);
        const Scalar high = high_ + share * (unexplained_from(high_, friction) - high_);
        if (step > 0) {
            high_ += step;
            low_ = std::min(low, high_);
        } else if (step < 0) {
            low_ += step;
            high_ = std::max(high, low_);
        } else {
            low_ = low;
            high_ = high;
        }
    }

    /// Returns the value closest to `edge` from which hysteresis of this friction explains the error.
    [[nodiscard]] Scalar unexplained_from(Scalar edge, Scalar friction) const noexcept {
        return std::clamp(edge, second_pole_ - friction * hysteresis_.high(),
                          second_pole_ - friction * hysteresis_.low());
    }

    void follow_usual(const Steps& steps) noexcept {
        usual_ *= std::abs(deviation_) > doubt_ * usual_ ? 1 + steps.median : 1 - steps.median;
        usual_ = std::clamp(usual_, least_usual, largest_usual);
    }

    [[nodiscard]] Scalar limit_from(const ContactLimits<Scalar>& limits) const noexcept {
        const Scalar growth = limits.usual > 0 ? usual_ / limits.usual : Scalar(1);
        const Scalar constant =
            limits.limit[static_cast<int>(motion_)] * std::clamp(growth, Scalar(1), most_growth);
        const Scalar proportional = limits.relative * predicted_change();
        return std::sqrt(constant * constant + proportional * proportional);
    }

    static constexpr Scalar largest_share = Scalar(1e6);
    static constexpr Scalar least_usual = Scalar(1e-12);
    static constexpr Scalar largest_usual = Scalar(1e12);

    Scalar position_, velocity_;      ///< rad, rad/s
    Scalar earlier_velocity_;         ///< rad/s, low-pass filtered
    Scalar acceleration_;             ///< rad/s²
    Scalar first_pole_, second_pole_; ///< of the error
    Scalar first_prediction_pole_, second_prediction_pole_, earlier_prediction_;
    FrictionHysteresis<Scalar> hysteresis_;
    Scalar low_, high_; ///< baseline; equal unless the motion changes
    Scalar deviation_, share_;
    Scalar doubt_; ///< factor on the limit
    Scalar usual_; ///< median of the deviation's magnitude while the joint moves
    Scalar since_change_s_;
    int direction_; ///< -1, 0, 1
    JointMotion motion_;
};

} // namespace dfdyn
