// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/vibration_watch.hpp"
#include "dfdyn/core/storage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace dfdyn {

/// Disturbance observer: estimates, per joint, the error of the feed-forward torque. With the estimate added
/// to the command, the feedback torque returns to zero.
///
/// Let F = P e + D de/dt be the feedback of the tracking error e, and J the inertia of the joint. The
/// disturbance is the sum of F, the observer's torque and J d²e/dt². Low-pass filtered with bandwidth b, the
/// estimate is
///
///     d = b (∫ F dt + J de/dt),   so that   (J s² + D s + P)(s + b) e = s · disturbance.
///
/// The poles of the feedback stay in place, and a pole at -b is added. After K. Ohnishi, "A new servo method
/// in mechatronics" (1987), written for the error, so that no acceleration is needed. The observer has no
/// memory: it estimates a disturbance that repeats with every motion, such as friction, each time with a lag
/// of 1/b. `FeedForward` learns such disturbances from the commands; the estimate then returns to zero.
///
/// `LoopMargin` computes the bandwidth that a loop tolerates. Rounded positions make de/dt noisy, and b J
/// de/dt more so than the damping of the feedback. The bandwidth is therefore at most `step` over the largest
/// change of J de/dt in a tick, which is remembered for about `memory_s`. Where the feedback itself changes
/// by more than `step` in a tick, what is more is taken off this `step`, down to a quarter of it. A change
/// counts in full in its own tick. At most 16 steps of it are remembered (32 of the feedback's), so that one
/// wrong value does not switch the observer off.
///
/// Elastic gears, of which the margin knows nothing, can make a joint vibrate. Each time `VibrationWatch`
/// finds that the torque of feedback and observer does so, the joint's bandwidth is halved, for good, down to
/// `least_share`. Pass `share()` to `FeedForward::observer_bandwidth_share`.
///
/// If the joint is blocked, the estimate rises to its limit. Cost: 26 multiply-adds per joint and tick, 3
/// more at a turn; 19 n + 2 scalars. Never allocates.
template <class Scalar, int n>
class DisturbanceObserver {
  public:
    using Torques = Storage<Scalar, n>; ///< n values, N·m (N for prismatic joints)

    static constexpr Scalar memory_s = 5;                  ///< time constant
    static constexpr Scalar least_share = Scalar(1) / 256; ///< that vibrations leave of a bandwidth

    /// Period, bandwidths and limits. A value outside its range is not detected.
    struct Settings {
        Scalar period_s;   ///< of a control tick; > 0
        Torques bandwidth; ///< per joint, rad/s; ≥ 0 and below 1 / period
        Torques limit;     ///< of |estimate|, per joint, N·m; ≥ 0
        Torques step;      ///< usual limit of the change of b J de/dt in a tick, per joint, N·m; > 0
        Torques swing;     ///< between turns of a vibration, per joint, N·m; ≥ 0; 0: not watched
    };

    /// Starts without an estimate. `joint_count`: n.
    DisturbanceObserver(Extent<n> joint_count, Settings settings) noexcept
        : joints_(joint_count), settings_(std::move(settings)), integral_(Torques::zeros(joint_count)),
          estimate_(integral_), bandwidth_(integral_), momentum_(integral_), change_(integral_),
          feedback_(integral_), feedback_change_(integral_), share_(integral_),
          watch_(joint_count, settings_.period_s) {
        std::fill(share_.begin(), share_.end(), Scalar(1));
    }

    /// Returns to the initial state: no estimate, no past. What vibrations left of the bandwidths stays.
    void restart() noexcept {
        watch_.restart();
        for (int k = 0; k < joints_; ++k) {
            integral_[k] = estimate_[k] = bandwidth_[k] = change_[k] = feedback_change_[k] = 0;
        }
    }

    /// Performs one tick and returns the estimate, N·m. All arguments have n values:
    ///  - `feedback`: torque of the feedback in this tick, N·m. Limit it like the command: otherwise a
    ///    single wrong position takes the estimate to its limit;
    ///  - `inertia`: approximate inertia, kg·m²; 0 if unknown, at the expense of damping;
    ///  - `error_rate`: rate of the tracking error, rad/s;
    ///  - `excess`: torque that limits and ramps removed from the last command, N·m. An estimate does not
    ///    grow against a limit (anti-windup).
    ///
    /// A NaN or infinite value, or a product of inertia and rate that could overflow, leaves the estimate of
    /// its joint unchanged. After a restart ticks are ignored until one has a rate whose product with the
    /// bandwidth and the inertia is within the limit.
    const Torques& update(const Scalar* feedback, const Scalar* inertia, const Scalar* error_rate,
                          const Scalar* excess) noexcept {
        for (int k = 0; k < joints_; ++k) {
            const Scalar momentum = inertia[k] * error_rate[k];
            const Scalar largest = 2 * (1 + settings_.bandwidth[k]) * momentum; // of all products below
            const bool first = bandwidth_[k] <= 0;
            // a wrong rate: the estimate could not follow it back
            const bool beyond = first && std::abs(settings_.bandwidth[k] * momentum) > settings_.limit[k];
            if (!std::isfinite(largest) || !std::isfinite(feedback[k]) || !std::isfinite(excess[k]) ||
                beyond) {
                watch_.pass(k);
                continue;
            }
            if (first) { // has no past
                momentum_[k] = momentum;
                feedback_[k] = feedback[k];
            }
            const Scalar before = bandwidth_[k] * momentum_[k];
            adapt_bandwidth(momentum, feedback[k], k);
            const Scalar most = settings_.limit[k];
            const Scalar rise = bandwidth_[k] * settings_.period_s * feedback[k];
            // a change of the bandwidth alone does not change the estimate
            const Scalar transfer = before - bandwidth_[k] * momentum_[k];
            const Scalar grown = integral_[k] + transfer + (rise * excess[k] > 0 ? 0 : rise);
            integral_[k] = std::clamp(grown, -most, most);
            momentum_[k] = momentum;
            feedback_[k] = feedback[k];
            estimate_[k] = std::clamp(integral_[k] + bandwidth_[k] * momentum, -most, most);
            if (watch_.vibrates(k, feedback[k] + estimate_[k], settings_.swing[k]) &&
                settings_.bandwidth[k] > 0) {
                share_[k] = std::max(share_[k] / 2, least_share);
            }
        }
        return estimate_;
    }

    /// Returns the torque to add to feed-forward and feedback, N·m.
    [[nodiscard]] const Torques& estimate() const noexcept { return estimate_; }

    /// Returns the integral part of the estimate, N·m: the part that remains while the error is constant. It
    /// holds the arm when the loop ends.
    [[nodiscard]] const Torques& lasting() const noexcept { return integral_; }

    /// Returns what vibrations left of each joint's bandwidth, `least_share` … 1; 1 for a bandwidth of 0.
    [[nodiscard]] const Torques& share() const noexcept { return share_; }

    /// Returns the largest number of multiply-adds of `update`.
    [[nodiscard]] static constexpr std::int64_t cost(Extent<n> joint_count) noexcept {
        return std::int64_t{29} * joint_count;
    }

  private:
    /// Largest changes that are remembered, in steps: of the estimate at the joint's bandwidth, and of the
    /// feedback.
    static constexpr Scalar most_remembered = 16, most_feedback_remembered = 32;

    /// Sets the bandwidth at which J de/dt changes the estimate by at most what the feedback's changes leave
    /// of twice the joint's step.
    void adapt_bandwidth(Scalar momentum, Scalar feedback, int k) noexcept {
        const Scalar kept = 1 - settings_.period_s / memory_s;
        change_[k] = std::max(std::abs(momentum - momentum_[k]), kept * change_[k]);
        feedback_change_[k] = std::max(std::abs(feedback - feedback_[k]), kept * feedback_change_[k]);
        const Scalar step = settings_.step[k], most = share_[k] * settings_.bandwidth[k];
        const Scalar left = std::clamp(2 * step - feedback_change_[k], step / 4, step);
        bandwidth_[k] = most * change_[k] > left ? left / change_[k] : most;
        if (most > 0) {
            change_[k] = std::min(change_[k], most_remembered * step / most);
        }
        feedback_change_[k] = std::min(feedback_change_[k], most_feedback_remembered * step);
    }

    [[no_unique_address]] Extent<n> joints_;
    Settings settings_;
    Torques integral_, estimate_;
    Torques bandwidth_;       ///< at the last tick, rad/s
    Torques momentum_;        ///< J de/dt at the last tick, N·m·s
    Torques change_;          ///< its largest change in a tick, N·m·s
    Torques feedback_;        ///< at the last tick, N·m
    Torques feedback_change_; ///< its largest change in a tick, N·m
    Torques share_;
    VibrationWatch<Scalar, n> watch_;
};

} // namespace dfdyn
