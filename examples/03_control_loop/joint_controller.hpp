// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../ur5/ur5_model.hpp" // constants, in flash
#include "dfdyn/control/disturbance_observer.hpp"
#include "dfdyn/control/feed_forward.hpp"
#include "dfdyn/control/learned_torque.hpp"
#include "dfdyn/control/loop_margin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

/// Detects new measurements by their time stamps. A stamp is new if it is later than the last new one, by at
/// most `longest_gap_ns`. After a longer gap, or after the clock was set, `agreeing` consecutive stamps in
/// order are required. A single wrong stamp therefore costs one measurement.
class StampClock {
  public:
    static constexpr std::uint64_t longest_gap_ns = 100'000'000; ///< between two measurements
    static constexpr int agreeing = 3; ///< consecutive stamps in order that restart the clock

    /// Restarts: the next new stamp is `time_ns` or a later one.
    void restart(std::int64_t time_ns) {
        accepted_ns_ = last_ns_ = time_ns - 1;
        in_a_row_ = 0;
    }

    /// Processes a stamp and returns true if its measurement is new. O(1).
    bool advances(std::int64_t time_ns) {
        in_a_row_ = follows(time_ns, last_ns_) ? std::min(in_a_row_ + 1, agreeing) : 1;
        last_ns_ = time_ns;
        const bool advances = follows(time_ns, accepted_ns_) || in_a_row_ == agreeing;
        accepted_ns_ = advances ? time_ns : accepted_ns_;
        return advances;
    }

  private:
    /// Returns true if the first stamp is later, by at most the gap. The unsigned difference cannot overflow.
    static bool follows(std::int64_t time_ns, std::int64_t before_ns) {
        return time_ns > before_ns &&
               static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(before_ns) <= longest_gap_ns;
    }

    std::int64_t accepted_ns_ = 0; // the last new stamp
    std::int64_t last_ns_ = 0;     // the last stamp
    int in_a_row_ = 0;             // consecutive stamps in order, at most `agreeing`
};

/// Delays values by `ticks` calls, for measurements that arrive late.
template <class T, int ticks>
class DelayLine {
    static_assert(ticks >= 0);

  public:
    /// Sets all past values.
    void fill(const T& value) { past_.fill(value); }

    /// Adds a value and returns the one of `ticks` calls ago, with 0 the value itself. O(1).
    const T& pass(const T& value) {
        past_[now_] = value;
        now_ = (now_ + 1) % past_.size();
        return past_[now_]; // the oldest
    }

  private:
    std::array<T, std::size_t{ticks + 1}> past_{};
    std::size_t now_ = 0;
};

/// Joint controller to copy and adapt: PD feedback, learned feed-forward and a disturbance observer. Call it
/// like a ros2_control controller: `activate` once, then `update` in each period. Efforts are in the unit of
/// the model's outputs, here A. The period is fixed at compile time. It needs no operating system and no
/// heap, and its time per tick is bounded.
///
/// `delay_ticks`: age of a measurement when `update` receives it, in ticks; use `JointController` for 0. A
/// measurement is compared with the reference, and learned with the effort, of its own time.
///
/// The *correction* is the sum of feedback and observer. It changes by at most `kick_share` of the limit per
/// tick, so that a wrong reading or a late tick makes no kick. An error that lasts takes it to the limit
/// within ten ticks: let the arm be at the reference before the brakes open. A joint without a new
/// measurement (NaN, or a stamp that does not advance) keeps its correction for `hold_ticks`. Then the
/// correction ramps to zero. When measurements return it ramps to its new value. A ramp changes by
/// `step_share` of the limit per tick. The controller does not stop the arm: stop it if
/// `ticks_without_sample` exceeds what your arm tolerates.
template <int delay_ticks>
class DelayedJointController {
  public:
    static constexpr int joints = 6; ///< of the arm and of the model
    static_assert(joints == ur5_model::Model::joints && joints == ur5_model::Model::outputs,
                  "the model is that of another arm");
    static constexpr std::int64_t period_ns = 1'000'000; ///< of `update`
    static constexpr int ticks_per_sample = 8;           ///< the model was trained on samples 8 ms apart
    static_assert(8 * period_ns * ticks_per_sample > 7 * ur5_model::constants.period_ns &&
                      8 * period_ns * ticks_per_sample < 9 * ur5_model::constants.period_ns,
                  "the model was trained at another sample period");
    static constexpr int hold_ticks = 5;            ///< ticks that a correction is held without measurement
    static constexpr float observer_share = 0.3F;   ///< of the limit: the observer's largest effort
    static constexpr float observer_step = 0.04F;   ///< of the limit: its change in a tick by noise
    static constexpr float vibration_swing = 0.05F; ///< of the limit: halves the observer's bandwidth
    static constexpr float kick_share = 0.1F;  ///< of the limit: largest change of a correction in a tick
    static constexpr float step_share = 0.02F; ///< same, of a ramp: 20 limits per second

    using Learned = dfdyn::LearnedTorque<ur5_model::Model>;     ///< the model and its state
    using Forward = dfdyn::FeedForward<Learned>;                ///< nominal and learned effort
    using Observer = dfdyn::DisturbanceObserver<float, joints>; ///< for the error of the feed-forward
    using Reference = dfdyn::Reference<float, joints>;          ///< position, velocity, acceleration
    using Efforts = dfdyn::Storage<float, joints>;              ///< one value per joint, A

    /// Measured state of the joints at one time.
    struct State {
        std::int64_t time_ns; ///< stamp of the measurement
        Efforts position;     ///< rad; NaN: not measured
        Efforts velocity;     ///< rad/s; NaN: not measured
    };

    /// Gains and limits of the loop, the same for all joints for brevity.
    struct Gains {
        float position;  ///< A/rad, ≥ 0
        float velocity;  ///< A·s/rad, ≥ 0
        float inertia;   ///< A·s²/rad, ≥ 0, approximate; 0 if unknown
        float limit;     ///< A, > 0
        float bandwidth; ///< of the observer, rad/s, ≥ 0, below 1 / period; see dfdyn::LoopMargin
    };

    /// Starts with the learned state of the model in flash. Call `activate` before the first `update`.
    explicit DelayedJointController(const Gains& gains)
        : gains_(gains), learned_(ur5_model::constants, ticks_per_sample),
          forward_(learned_, {.period_ns = period_ns,
                              .ticks_per_sample = ticks_per_sample,
                              .limit = all(gains.limit),
                              .cap = all(0.5F * gains.limit),
                              .rate = all(20 * gains.limit),
                              .bandwidth = all(gains.bandwidth),
                              .observer_limit = all(observer_share * gains.limit)}),
          observer_({}, {1e-9F * period_ns, all(gains.bandwidth), all(observer_share * gains.limit),
                         all(observer_step * gains.limit), all(vibration_swing * gains.limit)}),
          valid_(forward_.settings_valid() && std::isfinite(gains.position) && gains.position >= 0 &&
                 std::isfinite(gains.velocity) && gains.velocity >= 0 && std::isfinite(gains.inertia) &&
                 gains.inertia >= 0) {}

    DelayedJointController(const DelayedJointController&) = delete; // its parts refer to each other
    DelayedJointController& operator=(const DelayedJointController&) = delete;

    /// Returns whether the gains are usable. With others every effort is 0: do not release the brakes.
    [[nodiscard]] bool valid() const { return valid_; }

    /// Starts the controller. The arm must be at rest at the beginning of the reference.
    void activate(const State& state) {
        forward_.begin(state.time_ns, state.position.data());
        observer_.restart();
        effort_ = effort_then_ = excess_ = correction_ = all(0);
        references_.fill({state.position, all(0), all(0)}); // at rest until now
        efforts_.fill(effort_);
        applied_.fill(true);
        clock_.restart(state.time_ns);
        missed_ = {};
        recovering_ = {};
    }

    /// Performs one tick and returns the efforts to apply until the next one, A, within ± `limit`. `state`:
    /// newest measurement. `reference`: one tick later than in the last call. `nominal`: effort of your own
    /// model for the reference, A; zeros without a model. `applied`: false if the last efforts did not act on
    /// the arm, as with closed brakes or after an emergency stop. Then nothing is learned or integrated, and
    /// the corrections go to zero as without measurements.
    const Efforts& update(const State& state, const Reference& reference, const Efforts& nominal,
                          bool applied = true) {
        if (!valid_) {
            return effort_; // 0
        }
        const Efforts& forward = forward_.update(reference, nominal.data());
        const bool measured = correct(state, references_.pass(reference), applied);
        Efforts required; // by the motion, where known: the forecasts are compared with it
        for (int k = 0; k < joints; ++k) {
            effort_[k] = std::clamp(forward[k] + correction_[k], -gains_.limit, gains_.limit);
            excess_[k] = forward[k] + wanted_[k] - effort_[k]; // what limit and ramp removed
            correction_[k] = effort_[k] - forward[k];          // what acts: the next change starts from it
            const bool exact = missed_[k] == 0 && !recovering_[k] && excess_[k] == 0;
            required[k] = exact ? effort_[k] : unknown;
        }
        forward_.commanded(required.data());
        forward_.measured(state.time_ns, measured ? state.position.data() : nullptr, effort_then_.data());
        effort_then_ = efforts_.pass(effort_);
        return effort_;
    }

    /// Returns the number of ticks since the last new measurement of this joint. A tick whose efforts were
    /// not applied counts as one without.
    [[nodiscard]] int ticks_without_sample(int joint) const { return missed_[joint]; }

    /// Announces that the arm has changed or is not the arm of the training. Without this call the learner
    /// rejects many samples as outliers and adapts slowly.
    void relearn() { learned_.relearn(); }

    /// Includes or excludes the learned part, without a step in the effort.
    void enable_learned(bool on) { forward_.enable(on); }

    /// Returns the feed-forward: its share, its learned part, and the learner with its counters.
    [[nodiscard]] const Forward& forward() const { return forward_; }
    /// Returns the observer: its estimate, and what vibrations left of its bandwidths.
    [[nodiscard]] const Observer& observer() const { return observer_; }

    /// Returns a writer that saves the learned state in pieces between ticks, for example to flash.
    [[nodiscard]] auto snapshot_writer() { return learned_.snapshot_writer(); }
    /// Restores a saved state. Call it before `activate`. A rejected snapshot changes nothing.
    dfdyn::SnapshotResult restore(std::span<const std::byte> snapshot) { return learned_.restore(snapshot); }

  private:
    static Efforts all(float value) {
        Efforts filled;
        std::ranges::fill(filled, value);
        return filled;
    }

    /// Computes the corrections. `reference`: at the time of the measurement. Returns true if every joint has
    /// a new measurement.
    bool correct(const State& state, const Reference& reference, bool applied) {
        const bool acted = applied_.pass(applied); // at the time of the measurement
        const bool advanced = clock_.advances(state.time_ns) && applied && acted;
        Efforts error_rate, feedback, observed;
        for (int k = 0; k < joints; ++k) {
            error_rate[k] = reference.velocity[k] - state.velocity[k];
            feedback[k] = gains_.position * (reference.position[k] - state.position[k]) +
                          gains_.velocity * error_rate[k];
            const bool measured = advanced && std::isfinite(feedback[k]);
            missed_[k] = measured ? 0 : std::min(missed_[k] + 1, most_missed);
            // limited like the effort: one wrong reading must not throw the observer to its limit
            observed[k] = measured ? std::clamp(feedback[k], -gains_.limit, gains_.limit) : unknown;
        }
        const Efforts inertia = all(gains_.inertia);
        const Efforts& disturbance =
            observer_.update(observed.data(), inertia.data(), error_rate.data(), excess_.data());
        bool every = true;
        for (int k = 0; k < joints; ++k) {
            forward_.observer_bandwidth_share(k, observer_.share()[k]);
            if (missed_[k] == 0) {
                approach(k, feedback[k] + disturbance[k]);
            } else {
                recovering_[k] = true;
                approach(k, missed_[k] > hold_ticks ? 0.0F : correction_[k]);
            }
            every = every && missed_[k] == 0;
        }
        return every;
    }

    /// Moves a correction to `wanted`, by at most a share of the limit; a smaller one after missing
    /// measurements.
    void approach(int k, float wanted) {
        const float step = (recovering_[k] ? step_share : kick_share) * gains_.limit;
        const float before = correction_[k];
        wanted_[k] = wanted;
        correction_[k] = std::clamp(wanted, before - step, before + step);
        recovering_[k] = recovering_[k] && (missed_[k] > 0 || correction_[k] != wanted);
    }

    Gains gains_;
    Learned learned_;
    Forward forward_;
    Observer observer_;
    bool valid_;
    static constexpr int most_missed = 1'000'000; // the count saturates
    static constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

    Efforts effort_{};
    Efforts effort_then_{}; // in effect until the position of the next measurement was reached
    Efforts excess_{};
    Efforts wanted_{}, correction_{}; // of feedback and observer: without and with the limits
    DelayLine<Reference, delay_ticks> references_;
    DelayLine<Efforts, delay_ticks> efforts_;
    DelayLine<bool, delay_ticks> applied_;
    StampClock clock_;
    dfdyn::Storage<int, joints> missed_{};      // ticks since the last measurement
    dfdyn::Storage<bool, joints> recovering_{}; // the correction is limited in its rate
};

/// The controller for measurements of the present tick.
using JointController = DelayedJointController<0>;
