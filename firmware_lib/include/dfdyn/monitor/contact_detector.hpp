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
};

/// Detects contacts from the errors of predicted joint torques or motor currents, within some 0.1 s.
///
/// The deviation of a joint is its error (measured - predicted) after a low-pass filter with two poles, minus
/// a baseline that follows the error with the time constant `baseline_s`. So errors of weight, temperature or
/// payload, which change slowly, are not contacts. Friction jumps when a joint starts, stops or reverses. In
/// the `change_s` after that, the baseline is the whole interval between its last value and zero, the error
/// of an accurate model in motion.
///
/// A contact begins when the root of the sum of squares of all deviations, each in units of the limit for the
/// joint's motion, reaches 1. The baseline follows at most `clip` limits. During a contact it is the whole
/// interval between its value before and the value that it has followed to, so that the return of the error
/// is no second contact. A contact ends when the root has been below `release` for `release_s`. After
/// `longest_s` it ends as a change of the arm: the errors at that time become the baseline. On a motion where
/// deviations are larger than in training, limits grow in proportion to their median, at most by
/// `most_growth`; contacts do not change a median much, unless they fill half of the time. The first
/// `settling_s` after an interruption or a gap of `longest_gap_s` have no contact.
///
/// It is a detector, not a safety function: contacts below the limits or slower than the baseline are not
/// detected. The constants were chosen on the UR5 recordings No5 to No9, `contact_clip` on
/// pushes of a simulated UR5. Use in each tick:
///
///     const auto estimate = estimator.tick(sample, budget);
///     if (estimate.status.predicted() && measured) {
///         detector.tick(sample.time_ns, sample.position.data(), error);
///     } else {
///         detector.interrupt();
///     }
///
/// `joints` positions and errors, in the same order. No heap. Cost: `cost` per joint and tick, and three
/// exponentials. Memory: 14 numbers per joint.
template <class Scalar, int joints>
class ContactDetector {
  public:
    static constexpr Scalar filter_s = Scalar(0.025);         ///< time constant of each pole of the error, s
    static constexpr Scalar velocity_filter_s = Scalar(0.01); ///< time constant of the velocity's pole, s
    static constexpr Scalar baseline_s = Scalar(0.7);         ///< time constant of the baseline, s
    /// A joint whose deceleration brings it to rest within this time is about to stop, s.
    static constexpr Scalar stop_s = Scalar(0.1);
    static constexpr Scalar change_s = Scalar(0.2); ///< for which a change of the motion lasts, s
    static constexpr Scalar clip = Scalar(0.4); ///< largest deviation that the baseline follows, in limits
    static constexpr Scalar contact_clip = Scalar(0.1);  ///< the same during a contact
    static constexpr Scalar release = Scalar(0.75);      ///< of `excess()`: below it a contact may end
    static constexpr Scalar release_s = Scalar(0.1);     ///< time below `release` that ends a contact, s
    static constexpr Scalar longest_s = 3;               ///< of a contact; then it is a change of the arm, s
    static constexpr Scalar longest_gap_s = Scalar(0.1); ///< between two stamps; a longer one interrupts, s
    static constexpr Scalar settling_s = Scalar(0.5);    ///< after an interruption without contacts, s
    static constexpr Scalar median_s = 20;        ///< time in which a median doubles or halves, at least
    static constexpr Scalar most_growth = 4;      ///< largest factor by which a limit grows with its median
    static constexpr Scalar still = Scalar(0.02); ///< rad/s, largest speed of a standing joint
    static constexpr int cost = 24;               ///< multiply-adds per joint of `tick`, at most

    /// `limits`: one per joint; kept by reference.
    ContactDetector(Extent<joints> count, const ContactLimits<Scalar>* limits) noexcept
        : count_(count), limits_(limits), states_(States::zeros(count)) {
        for (int k = 0; k < count_; ++k) {
            std::copy_n(limits_[k].usual, joint_motion_count, states_[k].usual);
        }
    }

    /// Adds the positions (rad) and errors (the outputs' unit) at a stamp. Values that are not finite, and
    /// stamps that do not increase, interrupt. Returns true during a contact.
    bool tick(std::int64_t time_ns, const Scalar* position, const Scalar* error) noexcept {
        const Scalar dt = static_cast<Scalar>(time_ns - time_ns_) * Scalar(1e-9);
        time_ns_ = time_ns;
        if (!finite(position, error)) {
            interrupt();
            return false;
        }
        if (!running_ || !(dt > 0 && dt <= longest_gap_s)) {
            begin(position, error);
            return false;
        }
        const Steps steps(dt);
        Scalar sum = 0;
        Scalar largest = 0;
        for (int k = 0; k < count_; ++k) {
            const Scalar share = follow(k, position[k], error[k], steps);
            sum += share * share;
            largest_ = share > largest ? k : largest_;
            largest = std::max(largest, share);
        }
        excess_ = std::sqrt(sum);
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
    /// Returns the root of the sum of squares of this tick's deviations in units of their limits.
    [[nodiscard]] Scalar excess() const noexcept { return excess_; }
    /// Returns the motion of a joint in this tick, `joint` from 0.
    [[nodiscard]] JointMotion motion(int joint) const noexcept { return states_[joint].motion; }

  private:
    struct State {
        Scalar position, velocity;      ///< rad, rad/s
        Scalar earlier_velocity;        ///< rad/s, low-pass filtered
        Scalar first_pole, second_pole; ///< of the error
        Scalar low, high;               ///< baseline; equal unless the motion changes
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
              median(dt / median_s) {}
        Scalar dt, filter, velocity, baseline, median;
    };

    bool finite(const Scalar* position, const Scalar* error) const noexcept {
        const auto good = [](Scalar value) { return std::isfinite(value); };
        return std::all_of(position, position + count_, good) && std::all_of(error, error + count_, good);
    }

    void begin(const Scalar* position, const Scalar* error) noexcept {
        for (int k = 0; k < count_; ++k) {
            State& state = states_[k];
            state.position = position[k];
            state.velocity = state.earlier_velocity = 0;
            state.first_pole = state.second_pole = state.low = state.high = error[k];
            state.deviation = 0;
            state.direction = 0;
            state.since_change_s = change_s;
            state.motion = JointMotion::standing;
        }
        age_s_ = 0;
        excess_ = 0;
        contact_ = false;
        running_ = true;
    }

    /// Returns the magnitude of the deviation in units of its limit.
    Scalar follow(int k, Scalar position, Scalar error, const Steps& steps) noexcept {
        State& state = states_[k];
        state.velocity += steps.velocity * ((position - state.position) / steps.dt - state.velocity);
        state.position = position;
        state.earlier_velocity += steps.filter * (state.velocity - state.earlier_velocity);
        state.first_pole += steps.filter * (error - state.first_pole);
        state.second_pole += steps.filter * (state.first_pole - state.second_pole);
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
        if (state.motion == JointMotion::changing && !contact_) {
            settle(state);
        }
        state.motion = direction == 0 ? JointMotion::standing : JointMotion::moving;
    }

    /// Returns whether the present deceleration brings the joint to rest within `stop_s`.
    static bool stops_soon(const State& state) noexcept {
        const Scalar deceleration = (state.earlier_velocity - state.velocity) / filter_s;
        return state.velocity * (deceleration * stop_s - state.velocity) > 0;
    }

    /// Reduces the baseline to its value nearest to the error.
    static void settle(State& state) noexcept {
        state.low = state.high = std::clamp(state.second_pole, state.low, state.high);
    }

    void follow_baseline(State& state, Scalar limit, const Steps& steps) const noexcept {
        const Scalar most = (contact_ ? contact_clip : clip) * limit;
        const Scalar step = steps.baseline * std::clamp(state.deviation, -most, most);
        if (state.motion == JointMotion::changing || contact_) {
            state.low += std::min(step, Scalar(0));
            state.high += std::max(step, Scalar(0));
        } else {
            state.low += step;
            state.high = state.low;
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
        return limits_[k].limit[motion] * std::clamp(growth, Scalar(1), most_growth);
    }

    void decide(Scalar dt) noexcept {
        if (!contact_) {
            contact_ = excess_ >= 1 && age_s_ >= settling_s;
            if (contact_) {
                joint_ = largest_;
                lasted_s_ = quiet_s_ = 0;
            }
            return;
        }
        lasted_s_ += dt;
        quiet_s_ = excess_ < release ? quiet_s_ + dt : Scalar(0);
        if (quiet_s_ >= release_s) {
            end();
        } else if (lasted_s_ >= longest_s) {
            accept();
        }
    }

    void end() noexcept {
        for (State& state : states_) {
            if (state.motion != JointMotion::changing) {
                settle(state);
            }
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
    int largest_ = 0; ///< joint of the largest share in `excess_`
    int joint_ = 0;
    bool running_ = false;
    bool contact_ = false;
};

} // namespace dfdyn
