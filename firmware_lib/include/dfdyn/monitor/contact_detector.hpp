// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"
#include "dfdyn/monitor/joint_deviation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn {

/// Detects contacts from the errors of predicted joint torques or motor currents, within about 0.1 s.
///
/// A contact begins when the *excess* reaches 1. The excess is the 4-norm of all deviations (JointDeviation)
/// relative to their limits: close to the largest one, and larger if several joints deviate. Beyond the
/// speeds and accelerations of the training, all limits grow in proportion to the largest ratio, by at most
/// the factor `most_range`. They decrease again with the time constant `JointDeviation::range_s`.
///
/// A contact ends when for `release_s` the excess has been below `release`, or the deviation of its joint
/// below `release_share` of its largest value. The second condition separates consecutive pushes while a
/// model error remains. After `longest_s` it ends as a change of the arm: the errors at that time become the
/// baseline. No contact begins within `settling_s` after an interruption or a gap over `longest_gap_s`.
///
/// It is a detector, not a safety function: contacts below the limits or slower than the baseline are not
/// detected. docs/guide/contacts.md lists the recordings that chose the constants. Use in each tick:
///
///     const auto estimate = estimator.tick(sample, detector.informative() ? budget :
///     Budget::predict_only()); if (estimate.status.estimated() && sample.output_valid) {
///         for (int k = 0; k < joints; ++k) {
///             error[k] = sample.output[k] - estimate.prediction[k];
///         }
///         detector.tick(sample.time_ns, sample.position.data(), error, estimate.prediction.data(),
///                       estimate.standard_deviation.data());
///     } else {
///         detector.skip(sample.time_ns);
///     }
///
/// Do not use `Estimate::innovation`: it is 0 for an output beyond the model's limit, as in the hardest
/// collisions. After an interruption during a contact, the push that remains becomes the baseline. Positions,
/// errors, predictions and standard deviations have `joints` values in the same order; joints count from 0.
/// No heap. Cost: `cost` per joint and tick, and five exponentials. Memory: 25 numbers per joint.
template <class Scalar, int joints>
class ContactDetector {
  public:
    static constexpr Scalar release = Scalar(0.75);      ///< of `excess()`: below it a contact may end
    static constexpr Scalar release_share = Scalar(0.5); ///< same, of a contact's largest deviation
    static constexpr Scalar release_s = Scalar(0.1);     ///< time below either that ends a contact, s
    static constexpr Scalar longest_s = 3;               ///< longest contact, s; then a change of the arm
    static constexpr Scalar longest_gap_s = Scalar(0.1); ///< between two stamps, s; a longer one interrupts
    static constexpr int most_repeats = 100;             ///< of one stamp, in a row; more interrupt
    static constexpr Scalar settling_s = Scalar(0.5);    ///< after an interruption without contacts, s
    static constexpr Scalar most_range = 20; ///< an encoder's jump then masks contacts for a second only
    static constexpr Scalar largest_position = 10'000; ///< rad; a larger one is no position
    static constexpr int cost = 50;                    ///< maximum multiply-adds of `tick` per joint

    /// `limits`: one per joint; kept by reference.
    ContactDetector(Extent<joints> count, const ContactLimits<Scalar>* limits) noexcept
        : count_(count), limits_(limits), joints_(Storage<Joint, joints>::zeros(count)) {
        for (int k = 0; k < count_; ++k) {
            joints_[k].reset(limits_[k]);
        }
    }

    /// Adds the positions (rad), errors, predictions and the predictions' standard deviations (the outputs'
    /// unit) at a stamp. Returns true during a contact. Values that are not finite, and positions beyond ±
    /// `largest_position`, interrupt; of the standard deviations, a NaN counts as a usual one. After a gap,
    /// or if the stamp decreases, the comparison starts anew with these values, and a contact ends. A sample
    /// with the stamp of the last one is ignored, up to `most_repeats` in a row: a sensor slower than the
    /// loop, or a repeated frame.
    bool tick(std::int64_t time_ns, const Scalar* position, const Scalar* error, const Scalar* prediction,
              const Scalar* standard_deviation) noexcept {
        if (repeats(time_ns)) {
            return contact_;
        }
        const Scalar dt = since_last(time_ns);
        time_ns_ = time_ns;
        if (!valid(position, error, prediction)) {
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
            if (!contact_) {
                joints_[k].follow_doubt(standard_deviation[k], limits_[k], steps);
            }
            const Scalar share =
                joints_[k].follow(error[k], prediction[k], limits_[k], range_, contact_, steps);
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

    /// Registers a tick without a prediction or a measurement, at `time_ns` by the clock of the stamps.
    /// Interrupts only after `longest_gap_s` without one, or if the stamp decreases: until then a contact
    /// stays. A lost sample also costs an estimator the length of its window, which must be shorter
    /// than `longest_gap_s` for this to help. O(1).
    void skip(std::int64_t time_ns) noexcept {
        if (!repeats(time_ns) && (time_ns < time_ns_ || since_last(time_ns) > longest_gap_s)) {
            interrupt();
        }
    }

    /// Ends a contact and the comparison, which begins anew with the next tick: for a restart of the motion.
    void interrupt() noexcept {
        running_ = false;
        contact_ = false;
        excess_ = 0; // no suspicion without a comparison: a learner that waits for its end would wait forever
    }

    /// Returns whether a contact could begin in this tick: not within `settling_s` after an interruption.
    [[nodiscard]] bool settled() const noexcept { return running_ && age_s_ >= settling_s; }
    /// Returns whether errors are compared: not after an interruption.
    [[nodiscard]] bool running() const noexcept { return running_; }
    /// Returns whether the last contact was accepted as a change of the arm, because it did not end.
    [[nodiscard]] bool persistent() const noexcept { return persistent_; }
    /// Returns the number of joints.
    [[nodiscard]] int size() const noexcept { return count_; }
    /// Returns true during a contact, as the last `tick` did.
    [[nodiscard]] bool contact() const noexcept { return contact_; }
    /// Returns true during a contact and when one may begin: a learner should then not attribute the error to
    /// the arm.
    [[nodiscard]] bool suspected() const noexcept { return contact_ || excess_ >= release; }
    /// Returns whether the last sample describes the arm: a push does not, nor do joints that are all at
    /// rest, whose friction then bears torques that do not occur in motion. True also while the motion is
    /// unknown, after an interruption. O(joints).
    [[nodiscard]] bool informative() const noexcept {
        bool moves = !running_;
        for (int k = 0; k < count_; ++k) {
            moves = moves || motion(k) != JointMotion::standing;
        }
        return moves && !suspected();
    }
    /// Returns the joint with the largest deviation in units of its limit at the start of the last contact.
    [[nodiscard]] int joint() const noexcept { return joint_; }
    /// Returns the deviation of a joint in this tick, in its output's unit.
    [[nodiscard]] Scalar deviation(int joint) const noexcept { return joints_[joint].deviation(); }
    /// Returns the magnitude of a joint's deviation relative to its limit in this tick, >= 0.
    [[nodiscard]] Scalar share(int joint) const noexcept { return joints_[joint].share(); }
    /// Returns the recent change of a joint's prediction, in the output's unit.
    [[nodiscard]] Scalar predicted_change(int joint) const noexcept {
        return joints_[joint].predicted_change();
    }
    /// Returns the speed of a joint in rad/s, low-pass filtered.
    [[nodiscard]] Scalar speed(int joint) const noexcept { return joints_[joint].speed(); }
    /// Returns the magnitude of a joint's acceleration in rad/s², low-pass filtered.
    [[nodiscard]] Scalar acceleration(int joint) const noexcept { return joints_[joint].acceleration(); }
    /// Returns the excess in this tick: the 4-norm of the deviations relative to their limits, ≥ 0.
    [[nodiscard]] Scalar excess() const noexcept { return excess_; }
    /// Returns the motion of a joint in this tick, `joint` from 0.
    [[nodiscard]] JointMotion motion(int joint) const noexcept { return joints_[joint].motion(); }
    /// Returns the range of a joint's error that hysteresis explains, in units of its friction.
    [[nodiscard]] const FrictionHysteresis<Scalar>& hysteresis(int joint) const noexcept {
        return joints_[joint].hysteresis();
    }

  private:
    using Joint = JointDeviation<Scalar>;
    using Steps = typename Joint::Steps;

    /// Returns the time since the last stamp, s; 0 if this one is not later. The unsigned difference cannot
    /// overflow.
    [[nodiscard]] Scalar since_last(std::int64_t time_ns) const noexcept {
        const std::uint64_t step_ns =
            static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(time_ns_);
        return time_ns > time_ns_ ? static_cast<Scalar>(step_ns) * Scalar(1e-9) : Scalar(0);
    }

    /// Returns whether the values are finite. A huge finite position would leave an infinite velocity, which
    /// no later position corrects.
    bool valid(const Scalar* position, const Scalar* error, const Scalar* prediction) const noexcept {
        const auto near = [](Scalar value) { return std::abs(value) <= largest_position; };
        const auto good = [](Scalar value) { return std::isfinite(value); };
        return std::all_of(position, position + count_, near) && std::all_of(error, error + count_, good) &&
               std::all_of(prediction, prediction + count_, good);
    }

    void begin(const Scalar* position, const Scalar* error, const Scalar* prediction) noexcept {
        for (int k = 0; k < count_; ++k) {
            joints_[k].begin(position[k], error[k], prediction[k]);
        }
        age_s_ = 0;
        excess_ = 0;
        range_ = 1;
        contact_ = false;
        running_ = true;
    }

    /// Updates the motion and the factor by which it exceeds the training's.
    void follow_range(const Scalar* position, const Steps& steps) noexcept {
        Scalar range = 1;
        for (int k = 0; k < count_; ++k) {
            range = std::max(range, joints_[k].follow_motion(position[k], limits_[k], steps));
        }
        range_ = std::max(std::min(range, most_range), range_ + steps.range * (1 - range_));
    }

    void decide(Scalar dt) noexcept {
        if (!contact_) {
            contact_ = excess_ >= 1 && age_s_ >= settling_s;
            if (contact_) {
                joint_ = largest_;
                lasted_s_ = quiet_s_ = 0;
                peak_ = 0;
                persistent_ = false;
            }
            return;
        }
        lasted_s_ += dt;
        const Scalar size = std::abs(deviation(joint_));
        peak_ = std::max(peak_, size);
        quiet_s_ = excess_ < release || size < release_share * peak_ ? quiet_s_ + dt : Scalar(0);
        if (quiet_s_ >= release_s) {
            end();
        } else if (lasted_s_ >= longest_s) {
            accept();
        }
    }

    void end() noexcept {
        for (Joint& joint : joints_) {
            joint.end();
        }
        contact_ = false;
    }

    /// Takes the present errors as the baseline.
    void accept() noexcept {
        for (Joint& joint : joints_) {
            joint.accept();
        }
        contact_ = false;
        persistent_ = true;
    }

    /// Returns whether a stamp repeats the last one; interrupts if it does so too often.
    bool repeats(std::int64_t time_ns) noexcept {
        repeats_ = running_ && time_ns == time_ns_ ? repeats_ + 1 : 0;
        if (repeats_ > most_repeats) {
            interrupt();
        }
        return repeats_ > 0;
    }

    [[no_unique_address]] Extent<joints> count_;
    const ContactLimits<Scalar>* limits_;
    Storage<Joint, joints> joints_;
    std::int64_t time_ns_ = 0;
    Scalar age_s_ = 0; ///< since the beginning, at most `longest_s`
    Scalar lasted_s_ = 0, quiet_s_ = 0;
    Scalar excess_ = 0;
    Scalar peak_ = 0;  ///< magnitude of the deviation of the last contact's joint
    Scalar range_ = 1; ///< factor of all limits
    int largest_ = 0;  ///< joint of the largest share in `excess_`
    int joint_ = 0;
    int repeats_ = 0; ///< of the last stamp, in a row
    bool running_ = false;
    bool contact_ = false;
    bool persistent_ = false; ///< the last contact was accepted
};

} // namespace dfdyn
