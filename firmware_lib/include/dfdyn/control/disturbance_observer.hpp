// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace dfdyn {

/// Finds the torque that feed-forward leaves to the feedback, and takes it over, joint by joint.
///
/// With a feedback F = P e + D de/dt of the tracking error e, a feed-forward that is right but for a
/// disturbance, and the joint's inertia J, the disturbance is what F and this observer give less what the
/// error's acceleration takes; low-passed with the bandwidth b:
///
///     d = b (∫ F dt + J de/dt),   so that   (J s² + D s + P)(s + b) e = s · disturbance.
///
/// The feedback's own poles stay where they are, and one more comes, at -b. After K. Ohnishi, "A new servo
/// method in mechatronics" (1987), written for the error, so that no acceleration is needed. It has no
/// memory: a disturbance that recurs with every motion, such as friction, is estimated anew each time with a
/// lag of 1/b. `FeedForward` learns such disturbances from the commands; the estimate then returns to zero.
///
/// `LoopMargin` gives the bandwidth that a loop tolerates. When something blocks the joint, the estimate
/// rises to its limit.
///
/// Cost: 8 multiply-adds per joint and tick, 5 n + 1 scalars. Never allocates.
template <class Scalar, int n>
class DisturbanceObserver {
  public:
    using Torques = Storage<Scalar, n>;

    struct Settings {
        Scalar period_s;   ///< of a tick; > 0
        Torques bandwidth; ///< of each joint, rad/s; ≥ 0, and below 1 / period
        Torques limit;     ///< of |estimate|, N·m; ≥ 0
    };

    DisturbanceObserver(Extent<n> joint_count, Settings settings) noexcept
        : joints_(joint_count), settings_(std::move(settings)), integral_(Torques::zeros(joint_count)),
          estimate_(integral_) {}

    /// As if nothing had been observed.
    void restart() noexcept {
        for (int k = 0; k < joints_; ++k) {
            integral_[k] = estimate_[k] = 0;
        }
    }

    /// One tick, of n values each. `feedback`: its torque in this tick, N·m. `inertia`: kg·m², about; 0 where
    /// unknown, which costs damping. `error_rate`: of the tracking error, rad/s. `excess`: what the limits
    /// took off the last command, N·m: an estimate does not grow against a limit. A value that is no number
    /// leaves the joint's estimate as it is.
    const Torques& update(const Scalar* feedback, const Scalar* inertia, const Scalar* error_rate,
                          const Scalar* excess) noexcept {
        for (int k = 0; k < joints_; ++k) {
            const Scalar rise = settings_.bandwidth[k] * settings_.period_s * feedback[k];
            const Scalar fast = settings_.bandwidth[k] * inertia[k] * error_rate[k];
            if (!std::isfinite(rise) || !std::isfinite(fast)) {
                continue;
            }
            const Scalar most = settings_.limit[k];
            integral_[k] = std::clamp(integral_[k] + (rise * excess[k] > 0 ? 0 : rise), -most, most);
            estimate_[k] = std::clamp(integral_[k] + fast, -most, most);
        }
        return estimate_;
    }

    /// N·m, to be added to feed-forward and feedback.
    [[nodiscard]] const Torques& estimate() const noexcept { return estimate_; }

    /// The part of it that stays when the error does not change, N·m: what holds the arm when the loop ends.
    [[nodiscard]] const Torques& lasting() const noexcept { return integral_; }

    /// Multiply-adds of `update`.
    [[nodiscard]] static constexpr std::int64_t cost(Extent<n> joint_count) noexcept {
        return std::int64_t{8} * joint_count;
    }

  private:
    [[no_unique_address]] Extent<n> joints_;
    Settings settings_;
    Torques integral_, estimate_;
};

} // namespace dfdyn
