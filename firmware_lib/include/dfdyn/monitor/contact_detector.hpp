// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Motion of a joint, as friction depends on it. `changing`: it started, stopped or reversed a moment ago.
enum class JointMotion : std::uint8_t { standing, changing, moving };
inline constexpr int joint_motion_count = 3;

/// Properties of one joint's deviation (see ContactDetector) without contact, for each JointMotion, in the
/// output's unit. `dfdyn train` measures them.
template <class Scalar>
struct ContactLimits {
    Scalar limit[joint_motion_count]; ///< smallest deviation of a contact at this joint alone, > 0
    Scalar usual[joint_motion_count]; ///< median of the magnitude, >= 0
    Scalar relative;                  ///< added limit per recent change of the prediction, >= 0
    Scalar speed;                     ///< rad/s, largest usual, > 0
    Scalar acceleration;              ///< rad/s², largest usual, low-pass filtered, > 0
};

/// Detects contacts from the errors of predicted joint torques or motor currents, within some 0.1 s.
///
/// The deviation of a joint is its error (measured - predicted) after a low-pass filter with two poles, minus
/// a baseline that follows the error with the time constant `baseline_s`. So errors of weight, temperature or
/// payload, which change slowly, are not contacts. Friction jumps when a joint starts, stops or reverses. In
/// the `change_s` after that, the baseline is the whole interval between its last value and zero, the error
/// of an accurate model in motion.
///
/// A deviation is compared with a limit that grows in three ways:
/// - A model's error is partly proportional to what it predicts. The change of the prediction within
///   `baseline_s` times `relative` is added to the limit of the motion, as the root of the sum of squares.
/// - Beyond the speeds and accelerations of the training, the limits of all joints grow in proportion to the
///   largest ratio, at most `most_range`, and decrease again within `range_s`.
/// - Where deviations are larger than in training, a limit grows in proportion to their median, at most by
///   `most_growth`. Contacts do not change a median much, unless they fill half of the time.
///
/// A contact begins when the excess reaches 1: the fourth root of the sum of the fourth powers of all
/// deviations in units of their limits. It is close to the largest one, and larger if several joints deviate.
/// The baseline follows at most `clip` limits. During a contact it is the whole interval between its value
/// before and the value that it has followed to, so that the return of the error is no second contact. A
/// contact ends when for `release_s` the excess has been below `release`, or the deviation of its joint below
/// `release_share` of its largest value. So a push after another one is a contact of its own where the
/// model's error remains. After `longest_s` it ends as a change of the arm: the errors at that time become
/// the baseline. The first `settling_s` after an interruption or a gap of `longest_gap_s` have no contact.
///
/// It is a detector, not a safety function: contacts below the limits or slower than the baseline are not
/// detected. The constants were chosen on the UR5 recordings No5 to No9 and on pushes of a simulated UR5
/// (docs/guide/contacts.md). Use in each tick:
///
///     const auto estimate = estimator.tick(sample, budget);
///     if (estimate.status.predicted() && measured) {
///         detector.tick(sample.time_ns, sample.position.data(), error, prediction);
///     } else {
///         detector.interrupt();
///     }
///
/// `joints` positions, errors and predictions, in the same order. No heap. Cost: `cost` per joint and tick,
/// and four exponentials. Memory: 18 numbers per joint.
template <class Scalar, int joints>
class ContactDetector {
  public:
    static constexpr Scalar filter_s = Scalar(0.02);          ///< time constant of each pole of the error, s
    static constexpr Scalar velocity_filter_s = Scalar(0.01); ///< time constant of the velocity's pole, s
    static constexpr Scalar baseline_s = Scalar(0.7);         ///< time constant of the baseline, s
    /// A joint whose deceleration brings it to rest within this time is about to stop, s.
    static constexpr Scalar stop_s = Scalar(0.1);
    static constexpr Scalar change_s = Scalar(0.2); ///< for which a change of the motion lasts, s
    static constexpr Scalar clip = Scalar(0.4); ///< largest deviation that the baseline follows, in limits
    static constexpr Scalar contact_clip = Scalar(0.1);  ///< the same during a contact
    static constexpr Scalar release = Scalar(0.75);      ///< of `excess()`: below it a contact may end
    static constexpr Scalar release_share = Scalar(0.5); ///< of a contact's largest deviation: the same
    static constexpr Scalar release_s = Scalar(0.1);     ///< time below either that ends a contact, s
    static constexpr Scalar longest_s = 3;               ///< of a contact; then it is a change of the arm, s
    static constexpr Scalar longest_gap_s = Scalar(0.1); ///< between two stamps; a longer one interrupts, s
    static constexpr Scalar settling_s = Scalar(0.5);    ///< after an interruption without contacts, s
    static constexpr Scalar median_s = 20;         ///< time in which a median doubles or halves, at least
    static constexpr Scalar most_growth = 4;       ///< largest factor by which a limit grows with its median
    static constexpr Scalar range_s = Scalar(0.3); ///< time constant of the growth beyond the training, s
    static constexpr Scalar most_range = 20;       ///< so that an encoder's jump blinds for a second only
    static constexpr Scalar still = Scalar(0.02);  ///< rad/s, largest speed of a standing joint
    static constexpr int cost = 40;                ///< multiply-adds per joint of `tick`, at most

    /// `limits`: one per joint; kept by reference.
    ContactDetector(Extent<joints> count, const ContactLimits<Scalar>* limits) noexcept
        : count_(count), limits_(limits), states_(States::zeros(count)) {
        for (int k = 0; k < count_; ++k) {
            std::copy_n(limits_[k].usual, joint_motion_count, states_[k].usual);
        }
    }

    /// Adds the positions (rad), errors and predictions (the outputs' unit) at a stamp. Values that are not
    /// finite, and stamps that do not increase, interrupt. Returns true during a contact.
    bool tick(std::int64_t time_ns, const Scalar* position, const Scalar* error,
              const Scalar* prediction) noexcept {
        const Scalar dt = static_cast<Scalar>(time_ns - time_ns_) * Scalar(1e-9);
        time_ns_ = time_ns;
        if (!finite(position, error, prediction)) {
            interrupt();
            return false;
        }
        if (!running_ || !(dt > 0 && dt <= longest_gap_s)) {
            begin(position, error, prediction);
            return false;
        }
        const Steps steps(dt);
        follow_range(position, steps);
        Scalar sum = 0;
        Scalar largest = 0;
        for (int k = 0; k < count_; ++k) {
            const Scalar share = follow(k, error[k], prediction[k], steps);
            const Scalar square = share * share;
            sum += square * square;
            largest_ = share > largest ? k : largest_;
            largest = std::max(largest, share);
        }
        excess_ = std::sqrt(std::sqrt(sum));
        age_s_ = std::min(age_s_ + dt, longest_s);
        decide(dt);
        return contact_;
    }

    /// Registers a tick without a prediction or a measurement.
    void interrupt() noexcept {
        running_ = false;
        contact_ = false;
    }

    /// Returns whether errors are compared: not after an interruption.
    [[nodiscard]] bool running() const noexcept { return running_; }
    /// Returns whether the last contact was accepted as a change of the arm, because it did not end.
    [[nodiscard]] bool persistent() const noexcept { return lasted_s_ >= longest_s; }
    /// Returns the number of joints.
    [[nodiscard]] int size() const noexcept { return count_; }
    /// Returns whether a contact lasts, as the last `tick` did.
    [[nodiscard]] bool contact() const noexcept { return contact_; }
    /// Returns the joint with the largest deviation in units of its limit at the start of the last contact.
    [[nodiscard]] int joint() const noexcept { return joint_; }
    /// Returns the deviation of a joint in this tick, in its output's unit.
    [[nodiscard]] Scalar deviation(int joint) const noexcept { return states_[joint].deviation; }
    /// Returns the change of a joint's prediction within `baseline_s`, in the output's unit.
    [[nodiscard]] Scalar predicted_change(int joint) const noexcept {
        return states_[joint].second_prediction_pole - states_[joint].earlier_prediction;
    }
    /// Returns the speed of a joint in rad/s, low-pass filtered.
    [[nodiscard]] Scalar speed(int joint) const noexcept { return std::abs(states_[joint].velocity); }
    /// Returns the magnitude of a joint's acceleration in rad/s², low-pass filtered.
    [[nodiscard]] Scalar acceleration(int joint) const noexcept {
        return std::abs(states_[joint].acceleration);
    }
    /// Returns the fourth root of the sum of fourth powers of this tick's deviations in units of their
    /// limits.
    [[nodiscard]] Scalar excess() const noexcept { return excess_; }
    /// Returns the motion of a joint in this tick, `joint` from 0.
    [[nodiscard]] JointMotion motion(int joint) const noexcept { return states_[joint].motion; }

  private:
    struct State {
        Scalar position, velocity;      ///< rad, rad/s
        Scalar earlier_velocity;        ///< rad/s, low-pass filtered
        Scalar acceleration;            ///< rad/s²
        Scalar first_pole, second_pole; ///< of the error
        Scalar first_prediction_pole, second_prediction_pole, earlier_prediction;
        Scalar low, high; ///< baseline; equal unless the motion changes
        Scalar deviation;
        Scalar usual[joint_motion_count];
        Scalar since_change_s;
        int direction; ///< -1, 0, 1
        JointMotion motion;
    };
    using States = Storage<State, joints>;

    /// Shares of the present values in filters, for one tick.
    struct Steps {
        explicit Steps(Scalar period_s) noexcept
            : dt(period_s), filter(1 - std::exp(-dt / filter_s)),
              velocity(1 - std::exp(-dt / velocity_filter_s)), baseline(1 - std::exp(-dt / baseline_s)),
              range(1 - std::exp(-dt / range_s)), median(dt / median_s) {}
        Scalar dt, filter, velocity, baseline, range, median;
    };

    bool finite(const Scalar* position, const Scalar* error, const Scalar* prediction) const noexcept {
        const auto good = [](Scalar value) { return std::isfinite(value); };
        return std::all_of(position, position + count_, good) && std::all_of(error, error + count_, good) &&
               std::all_of(prediction, prediction + count_, good);
    }

    void begin(const Scalar* position, const Scalar* error, const Scalar* prediction) noexcept {
        for (int k = 0; k < count_; ++k) {
            State& state = states_[k];
            state.position = position[k];
            state.velocity = state.earlier_velocity = state.acceleration = 0;
            state.first_prediction_pole = state.second_prediction_pole = prediction[k];
            state.earlier_prediction = prediction[k];
            state.first_pole = state.second_pole = state.low = state.high = error[k];
            state.deviation = 0;
            state.direction = 0;
            state.since_change_s = change_s;
            state.motion = JointMotion::standing;
        }
        age_s_ = 0;
        excess_ = 0;
        range_ = 1;
        contact_ = false;
        running_ = true;
    }

    /// Follows the motion, and how far it is outside the usual one.
    void follow_range(const Scalar* position, const Steps& steps) noexcept {
        Scalar range = 1;
        for (int k = 0; k < count_; ++k) {
            State& state = states_[k];
            state.velocity += steps.velocity * ((position[k] - state.position) / steps.dt - state.velocity);
            state.position = position[k];
            state.earlier_velocity += steps.filter * (state.velocity - state.earlier_velocity);
            const Scalar acceleration = (state.velocity - state.earlier_velocity) / filter_s;
            state.acceleration += steps.filter * (acceleration - state.acceleration);
            range = std::max(
                {range, speed(k) / limits_[k].speed, this->acceleration(k) / limits_[k].acceleration});
        }
        range_ = std::max(std::min(range, most_range), range_ + steps.range * (1 - range_));
    }

    /// Returns the magnitude of the deviation in units of its limit.
    Scalar follow(int k, Scalar error, Scalar prediction, const Steps& steps) noexcept {
        State& state = states_[k];
        state.first_pole += steps.filter * (error - state.first_pole);
        state.second_pole += steps.filter * (state.first_pole - state.second_pole);
        state.first_prediction_pole += steps.filter * (prediction - state.first_prediction_pole);
        state.second_prediction_pole +=
            steps.filter * (state.first_prediction_pole - state.second_prediction_pole);
        state.earlier_prediction +=
            steps.baseline * (state.second_prediction_pole - state.earlier_prediction);
        classify(state, steps.dt);
        state.deviation = state.second_pole - std::clamp(state.second_pole, state.low, state.high);
        const Scalar limit = limit_of(k);
        follow_baseline(state, limit, steps);
        if (!contact_) {
            follow_usual(state, steps);
        }
        return std::min(std::abs(state.deviation) / limit, largest_share);
    }

    void classify(State& state, Scalar dt) const noexcept {
        const int direction = std::abs(state.velocity) < still ? 0 : (state.velocity > 0 ? 1 : -1);
        state.since_change_s = std::min(state.since_change_s + dt, change_s);
        if (direction != state.direction || (direction != 0 && stops_soon(state))) {
            state.low = std::min(state.low, Scalar(0));
            state.high = std::max(state.high, Scalar(0));
            state.direction = direction;
            state.since_change_s = 0;
        }
        if (state.since_change_s < change_s) {
            state.motion = JointMotion::changing;
            return;
        }
        state.motion = direction == 0 ? JointMotion::standing : JointMotion::moving;
    }

    /// Returns whether the present deceleration brings the joint to rest within `stop_s`.
    static bool stops_soon(const State& state) noexcept {
        const Scalar deceleration = (state.earlier_velocity - state.velocity) / filter_s;
        return state.velocity * (deceleration * stop_s - state.velocity) > 0;
    }

    void follow_baseline(State& state, Scalar limit, const Steps& steps) const noexcept {
        const Scalar most = (contact_ ? contact_clip : clip) * limit;
        const Scalar step = steps.baseline * std::clamp(state.deviation, -most, most);
        if (state.motion == JointMotion::changing || contact_) {
            state.low += std::min(step, Scalar(0));
            state.high += std::max(step, Scalar(0));
        } else {
            approach(state, step, steps.baseline);
        }
    }

    /// Moves the baseline towards the error: by `step` the edge that the error is beyond, by a share of its
    /// distance the other one.
    static void approach(State& state, Scalar step, Scalar share) noexcept {
        const Scalar low = state.low + share * (state.second_pole - state.low);
        const Scalar high = state.high + share * (state.second_pole - state.high);
        if (step > 0) {
            state.high += step;
            state.low = std::min(low, state.high);
        } else if (step < 0) {
            state.low += step;
            state.high = std::max(high, state.low);
        } else {
            state.low = low;
            state.high = high;
        }
    }

    static void follow_usual(State& state, const Steps& steps) noexcept {
        Scalar& usual = state.usual[static_cast<int>(state.motion)];
        usual *= std::abs(state.deviation) > usual ? 1 + steps.median : 1 - steps.median;
        usual = std::clamp(usual, least_usual, largest_usual);
    }

    [[nodiscard]] Scalar limit_of(int k) const noexcept {
        const int motion = static_cast<int>(states_[k].motion);
        const Scalar trained = limits_[k].usual[motion];
        const Scalar growth = trained > 0 ? states_[k].usual[motion] / trained : Scalar(1);
        const Scalar constant = limits_[k].limit[motion] * std::clamp(growth, Scalar(1), most_growth);
        const Scalar proportional = limits_[k].relative * predicted_change(k);
        return range_ * std::sqrt(constant * constant + proportional * proportional);
    }

    void decide(Scalar dt) noexcept {
        if (!contact_) {
            contact_ = excess_ >= 1 && age_s_ >= settling_s;
            if (contact_) {
                joint_ = largest_;
                lasted_s_ = quiet_s_ = 0;
                peak_ = 0;
            }
            return;
        }
        lasted_s_ += dt;
        const Scalar size = std::abs(states_[joint_].deviation);
        peak_ = std::max(peak_, size);
        quiet_s_ = excess_ < release || size < release_share * peak_ ? quiet_s_ + dt : Scalar(0);
        if (quiet_s_ >= release_s) {
            end();
        } else if (lasted_s_ >= longest_s) {
            accept();
        }
    }

    /// The baseline has the errors before the contact and the present ones.
    void end() noexcept {
        for (State& state : states_) {
            state.low = std::min(state.low, state.second_pole);
            state.high = std::max(state.high, state.second_pole);
        }
        contact_ = false;
    }

    /// Takes the present errors as the baseline.
    void accept() noexcept {
        for (State& state : states_) {
            state.low = state.high = state.second_pole;
        }
        contact_ = false;
    }

    static constexpr Scalar largest_share = Scalar(1e6);
    static constexpr Scalar least_usual = Scalar(1e-12);
    static constexpr Scalar largest_usual = Scalar(1e12);

    [[no_unique_address]] Extent<joints> count_;
    const ContactLimits<Scalar>* limits_;
    States states_;
    std::int64_t time_ns_ = 0;
    Scalar age_s_ = 0; ///< since the beginning, at most `longest_s`
    Scalar lasted_s_ = 0, quiet_s_ = 0;
    Scalar excess_ = 0;
    Scalar peak_ = 0;  ///< magnitude of the deviation of the last contact's joint
    Scalar range_ = 1; ///< factor of all limits
    int largest_ = 0;  ///< joint of the largest share in `excess_`
    int joint_ = 0;
    bool running_ = false;
    bool contact_ = false;
};

} // namespace dfdyn
