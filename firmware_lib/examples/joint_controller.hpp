// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/disturbance_observer.hpp"
#include "dfdyn/control/feed_forward.hpp"
#include "dfdyn/control/learned_torque.hpp"
#include "dfdyn/control/loop_margin.hpp"
#include "ur5_model.hpp" // constants, in flash

#include <algorithm>
#include <cmath>
#include <cstdint>

/// A controller to copy and adapt, with the interface of ros2_control: `activate`, then `update` in each
/// period. It contains feedback, the learned feed-forward and an observer for the remaining disturbance.
/// Efforts are in the unit of the model's outputs, here A. No operating system, no heap, bounded time per
/// tick.
class JointController {
  public:
    static constexpr int joints = 6;
    static constexpr std::int64_t period_ns = 1'000'000;
    static constexpr int ticks_per_sample = 8; // the model was trained on samples 8 ms apart

    using Learned = dfdyn::LearnedTorque<ur5_model::Model>;
    using Forward = dfdyn::FeedForward<Learned>;
    using Observer = dfdyn::DisturbanceObserver<float, joints>;
    using Reference = dfdyn::Reference<float, joints>;
    using Efforts = dfdyn::Storage<float, joints>;

    /// Measured state of the joints at one time.
    struct State {
        std::int64_t time_ns;
        Efforts position; // rad
        Efforts velocity; // rad/s
    };

    /// Gains and limits of the loop, the same for all joints for brevity.
    struct Gains {
        float position;  // A/rad
        float velocity;  // A·s/rad
        float inertia;   // A·s²/rad, approximate
        float limit;     // A
        float bandwidth; // of the observer, rad/s; see dfdyn::LoopMargin
    };

    explicit JointController(const Gains& gains)
        : gains_(gains), learned_(ur5_model::constants, ticks_per_sample),
          forward_(learned_, {.period_ns = period_ns,
                              .ticks_per_sample = ticks_per_sample,
                              .limit = all(gains.limit),
                              .cap = all(0.5F * gains.limit),
                              .rate = all(20 * gains.limit)}),
          observer_({}, {1e-9F * period_ns, all(gains.bandwidth), all(0.3F * gains.limit)}) {}

    /// Starts the controller. The arm rests at the beginning of the reference.
    void activate(const State& state) {
        forward_.begin(state.time_ns, state.position.data());
        observer_.restart();
        effort_ = excess_ = all(0);
    }

    /// Returns the efforts until the next period. `nominal`: effort of your own model for the reference;
    /// zeros without one.
    const Efforts& update(const State& state, const Reference& reference, const Efforts& nominal) {
        const Efforts before = effort_; // in effect until the present position was reached
        Efforts error_rate, feedback;
        for (int k = 0; k < joints; ++k) {
            error_rate[k] = reference.velocity[k] - state.velocity[k];
            feedback[k] = gains_.position * (reference.position[k] - state.position[k]) +
                          gains_.velocity * error_rate[k];
        }
        const Efforts inertia = all(gains_.inertia);
        const Efforts& forward = forward_.update(reference, nominal.data());
        const Efforts& disturbance =
            observer_.update(feedback.data(), inertia.data(), error_rate.data(), excess_.data());
        for (int k = 0; k < joints; ++k) {
            const float wanted = forward[k] + feedback[k] + disturbance[k];
            // A NaN position must not reach the motors; the feed-forward is always finite.
            effort_[k] = std::isfinite(wanted) ? std::clamp(wanted, -gains_.limit, gains_.limit) : forward[k];
            excess_[k] = std::isfinite(wanted) ? wanted - effort_[k] : 0;
        }
        const bool limited =
            std::any_of(excess_.begin(), excess_.end(), [](float excess) { return excess != 0; });
        if (!limited) { // a limited effort is not the one that the motion needs
            forward_.commanded(effort_.data());
        }
        forward_.measured(state.time_ns, state.position.data(), before.data());
        return effort_;
    }

    /// Switches the learned part on and off, without a step.
    void enable_learned(bool on) { forward_.enable(on); }

    [[nodiscard]] const Forward& forward() const { return forward_; }

  private:
    static Efforts all(float value) { return {{value, value, value, value, value, value}}; }

    Gains gains_;
    Learned learned_;
    Forward forward_;
    Observer observer_;
    Efforts effort_{}, excess_{};
};
