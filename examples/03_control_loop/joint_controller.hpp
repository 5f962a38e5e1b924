// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../ur5/ur5_model.hpp" // constants, in flash
#include "dfdyn/control/disturbance_observer.hpp"
#include "dfdyn/control/feed_forward.hpp"
#include "dfdyn/control/learned_torque.hpp"
#include "dfdyn/control/loop_margin.hpp"

#include <algorithm>
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

/// Joint controller to copy and adapt: PD feedback, learned feed-forward and a disturbance observer. Call it
/// like a ros2_control controller: `activate` once, then `update` in each period. Efforts are in the unit of
/// the model's outputs, here A. The period is fixed at compile time. It needs no operating system and no
/// heap, and its time per tick is bounded.
///
/// The *correction* is the sum of feedback and observer. A joint without a new measurement (NaN, or a stamp
/// that does not advance) keeps its correction for `hold_ticks`. Then the correction ramps to zero. When
/// measurements return it ramps to its new value. A ramp changes by `step_share` of the limit per tick. The
/// controller does not stop the arm: stop it if `ticks_without_sample` exceeds what your arm tolerates.
class JointController {
  public:
    static constexpr int joints = 6;                     ///< of the arm and of the model
    static constexpr std::int64_t period_ns = 1'000'000; ///< of `update`
    static constexpr int ticks_per_sample = 8;           ///< the model was trained on samples 8 ms apart
    static_assert(8 * period_ns * ticks_per_sample > 7 * ur5_model::constants.period_ns &&
                      8 * period_ns * ticks_per_sample < 9 * ur5_model::constants.period_ns,
                  "the model was trained at another sample period");
    static constexpr int hold_ticks = 5;            ///< ticks that a correction is held without measurement
    static constexpr float observer_share = 0.3F;   ///< of the limit: the observer's largest effort
    static constexpr float observer_step = 0.04F;   ///< of the limit: its change in a tick by noise
    static constexpr float vibration_swing = 0.05F; ///< of the limit: halves the observer's bandwidth
    static constexpr float step_share = 0.02F;      ///< of the limit, per tick: 20 limits per second

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
        float position;  ///< A/rad, > 0
        float velocity;  ///< A·s/rad, > 0
        float inertia;   ///< A·s²/rad, approximate; 0 if unknown
        float limit;     ///< A, > 0
        float bandwidth; ///< of the observer, rad/s, ≥ 0; see dfdyn::LoopMargin
    };

    /// Starts with the learned state of the model in flash. Call `activate` before the first `update`.
    explicit JointController(const Gains& gains)
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
                 std::isfinite(gains.velocity) && gains.velocity >= 0 && std::isfinite(gains.inertia)) {}

    JointController(const JointController&) = delete; // its parts refer to each other
    JointController& operator=(const JointController&) = delete;

    /// Returns whether the gains are usable. With others every effort is 0: do not release the brakes.
    [[nodiscard]] bool valid() const { return valid_; }

    /// Starts the controller. The arm must be at rest at the beginning of the reference.
    void activate(const State& state) {
        forward_.begin(state.time_ns, state.position.data());
        observer_.restart();
        effort_ = excess_ = correction_ = all(0);
        clock_.restart(state.time_ns);
        missed_ = {};
        recovering_ = {};
    }

    /// Performs one tick and returns the efforts to apply until the next one, A, within ± `limit`. `state`:
    /// newest measurement. `nominal`: effort of your own model for the reference, A; zeros without a model.
    const Efforts& update(const State& state, const Reference& reference, const Efforts& nominal) {
        if (!valid_) {
            return effort_; // 0
        }
        const Efforts before = effort_; // in effect until the present position was reached
        const Efforts& forward = forward_.update(reference, nominal.data());
        const bool exact = correct(state, reference);
        bool limited = !exact; // the effort then differs from what the motion requires
        for (int k = 0; k < joints; ++k) {
            const float wanted = forward[k] + correction_[k];
            effort_[k] = std::clamp(wanted, -gains_.limit, gains_.limit);
            excess_[k] = wanted - effort_[k];
            limited = limited || excess_[k] != 0;
        }
        if (!limited) {
            forward_.commanded(effort_.data());
        }
        forward_.measured(state.time_ns, exact ? state.position.data() : nullptr, before.data());
        return effort_;
    }

    /// Returns the number of ticks since the last new measurement of this joint.
    [[nodiscard]] int ticks_without_sample(int joint) const { return missed_[joint]; }

    /// Announces that the arm has changed or is not the arm of the training. Without this call the learner
    /// rejects many samples as outliers and adapts slowly.
    void relearn() { learned_.relearn(); }

    /// Includes or excludes the learned part, without a step in the effort.
    void enable_learned(bool on) { forward_.enable(on); }

    /// Returns the feed-forward: its share, its learned part, and the learner with its counters.
    [[nodiscard]] const Forward& forward() const { return forward_; }

    /// Returns a writer that saves the learned state in pieces between ticks, for example to flash.
    [[nodiscard]] auto snapshot_writer() { return learned_.snapshot_writer(); }
    /// Restores a saved state. Call it before `activate`. A rejected snapshot changes nothing.
    dfdyn::SnapshotResult restore(std::span<const std::byte> snapshot) { return learned_.restore(snapshot); }

  private:
    static Efforts all(float value) { return {{value, value, value, value, value, value}}; }

    /// Computes the corrections. Returns true if every joint has a new measurement and no correction is
    /// rate-limited.
    bool correct(const State& state, const Reference& reference) {
        const bool advanced = clock_.advances(state.time_ns);
        Efforts error_rate, feedback;
        for (int k = 0; k < joints; ++k) {
            error_rate[k] = reference.velocity[k] - state.velocity[k];
            feedback[k] = gains_.position * (reference.position[k] - state.position[k]) +
                          gains_.velocity * error_rate[k];
            if (!advanced || !std::isfinite(feedback[k])) { // the observer ignores NaN
                feedback[k] = std::numeric_limits<float>::quiet_NaN();
            }
            missed_[k] = std::isfinite(feedback[k]) ? 0 : std::min(missed_[k] + 1, most_missed);
        }
        const Efforts inertia = all(gains_.inertia);
        const Efforts& disturbance =
            observer_.update(feedback.data(), inertia.data(), error_rate.data(), excess_.data());
        bool exact = true;
        for (int k = 0; k < joints; ++k) {
            forward_.observer_bandwidth_share(k, observer_.share()[k]);
            if (missed_[k] == 0) {
                approach(k, feedback[k] + disturbance[k]);
            } else if (missed_[k] > hold_ticks) {
                recovering_[k] = true;
                approach(k, 0);
            } else {
                recovering_[k] = true;
            }
            exact = exact && missed_[k] == 0 && !recovering_[k];
        }
        return exact;
    }

    /// Sets a correction to `wanted`; after missing measurements it ramps there.
    void approach(int k, float wanted) {
        const float step = step_share * gains_.limit;
        const float before = correction_[k];
        correction_[k] = recovering_[k] ? std::clamp(wanted, before - step, before + step) : wanted;
        recovering_[k] = recovering_[k] && (missed_[k] > 0 || correction_[k] != wanted);
    }

    Gains gains_;
    Learned learned_;
    Forward forward_;
    Observer observer_;
    bool valid_;
    static constexpr int most_missed = 1'000'000; // the count saturates

    Efforts effort_{}, excess_{};
    Efforts correction_{}; // of feedback and observer
    StampClock clock_;
    dfdyn::Storage<int, joints> missed_{};      // ticks since the last measurement
    dfdyn::Storage<bool, joints> recovering_{}; // the correction is limited in its rate
};
