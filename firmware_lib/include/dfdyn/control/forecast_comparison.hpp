// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/feed_forward_settings.hpp"
#include "dfdyn/forecast_combination.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace dfdyn {

/// Compares the nominal torque and the forecasts of each joint with the joint's commands, and weights them by
/// their errors over the last `memory_s`: the part of `FeedForward` that decides which torque is right.
///
/// Each joint is compared by itself, once per knot: in the first tick from it on that has a command of
/// the joint. A joint without commands keeps its weights; the slow parts of its errors fade. Tables contain n
/// values per torque: first the nominal torques, then the forecasts. Cost: `cost()`. Never allocates.
template <class Scalar, int forecasts, int n>
class ForecastComparison {
  public:
    using Torques = Storage<Scalar, n>;              ///< n values, N·m (N for prismatic joints)
    using Settings = FeedForwardSettings<Scalar, n>; ///< limits and times

    /// `settings`: valid ones, the same as in the calls.
    ForecastComparison(Extent<forecasts> forecast_count, Extent<n> joint_count,
                       const Settings& settings) noexcept
        : joints_(joint_count), torques_(extent<sum(forecasts, 1)>(forecast_count + 1)),
          knots_(std::max(1, static_cast<int>(settings.memory_s / settings.sample_period_s()))),
          combination_(torques_, joints_, settings.memory_s / settings.sample_period_s()),
          slow_(Table::zeros(extent<product(sum(forecasts, 1), n)>(torques_ * joints_))), error_(slow_),
          followed_(Torques::zeros(joints_)), target_(followed_), due_(Counts::zeros(joints_)),
          compared_(due_) {
        restart();
    }

    /// Sets the bandwidth, rad/s, with which an observer takes over the errors of joint `k`.
    void follow(int k, Scalar bandwidth, const Settings& settings) noexcept {
        followed_[k] = std::min(bandwidth * settings.sample_period_s(), Scalar(1));
    }

    /// Forgets all errors; keeps the bandwidths.
    void restart() noexcept {
        combination_.restart();
        std::fill(slow_.begin(), slow_.end(), Scalar(0));
        for (int k = 0; k < joints_; ++k) {
            due_[k] = compared_[k] = 0;
        }
        waits_ = false;
        std::fill(target_.begin(), target_.end(), std::numeric_limits<Scalar>::quiet_NaN());
    }

    /// Begins a knot. The slow errors of joints that were not compared since the last one fade.
    void begin_knot() noexcept {
        learn();
        for (int i = 0; i < slow_.size(); ++i) {
            const int k = i % joints_;
            if (due_[k] != 0) {
                slow_[i] -= followed_[k] * slow_[i];
            }
        }
        std::fill(due_.begin(), due_.end(), 1);
    }

    /// Compares the joints that are not compared yet since the last knot. `torque`: the commands, n values,
    /// N·m; NaN or infinite for a joint that is not compared now. `forecast(i)`: element i of the table of
    /// torques in this tick, finite.
    template <class Forecast>
    void compare(const Scalar* torque, const Settings& settings, const Forecast& forecast) noexcept {
        bool every = true;
        for (int k = 0; k < joints_; ++k) {
            if (due_[k] == 0 || !std::isfinite(torque[k])) {
                every = every && due_[k] == 0;
                continue;
            }
            target_[k] = 0;
            due_[k] = 0;
            waits_ = true;
            compared_[k] = std::min<std::int32_t>(compared_[k] + 1, knots_);
            for (int i = k; i < slow_.size(); i += joints_) {
                const Scalar error = bounded(forecast(i) - torque[k], settings.limit[k]);
                const Scalar taken_over = bounded(slow_[i], settings.observer_limit[k]);
                error_[i] = error - (1 - settings.slow_share) * taken_over;
                slow_[i] += followed_[k] * (error - slow_[i]);
            }
        }
        if (every) {
            learn();
        }
    }

    /// Returns whether joint `k` was compared for `memory_s` since the restart.
    [[nodiscard]] bool judged(int k) const noexcept { return compared_[k] >= knots_; }
    /// Returns the weights, a table; those of a joint sum to 1.
    [[nodiscard]] const Scalar* weights() const noexcept { return combination_.weights(); }

    /// Returns `value` within ± `limit`, N·m; 0 for NaN or infinity.
    static Scalar bounded(Scalar value, Scalar limit) noexcept {
        return std::isfinite(value) ? std::clamp(value, -limit, limit) : Scalar(0);
    }

    /// Returns the maximum multiply-adds of `begin_knot` and `compare` together, without `forecast`.
    [[nodiscard]] std::int64_t cost() const noexcept {
        return 3 * slow_.size() + Combination::cost(torques_, joints_).learn;
    }

  private:
    using Table = Storage<Scalar, product(sum(forecasts, 1), n)>;
    using Counts = Storage<std::int32_t, n>;
    using Combination = ForecastCombination<Scalar, sum(forecasts, 1), n>;

    /// Weights the forecasts by the errors since the last knot: at most once per knot, because the
    /// combination counts its samples for all joints together.
    void learn() noexcept {
        if (!waits_) {
            return;
        }
        combination_.learn(error_.data(), target_.data());
        waits_ = false;
        std::fill(target_.begin(), target_.end(), std::numeric_limits<Scalar>::quiet_NaN());
    }

    [[no_unique_address]] Extent<n> joints_;
    [[no_unique_address]] Extent<sum(forecasts, 1)> torques_; ///< of a joint: nominal and forecasts
    std::int32_t knots_;                                      ///< of `memory_s`
    Combination combination_;
    Table slow_, error_; ///< errors: low-pass filtered, and as compared
    Torques followed_;   ///< gain of the low-pass filter per sample period
    Torques target_;     ///< of the errors: 0; NaN for a joint that is not compared
    bool waits_ = false; ///< errors that the weights do not contain yet
    Counts due_;         ///< 1: not compared since the last knot
    Counts compared_;    ///< number of compared knots, at most `knots_`
};

} // namespace dfdyn
