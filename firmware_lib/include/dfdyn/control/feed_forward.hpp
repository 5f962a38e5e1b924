// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/control/feed_forward_settings.hpp"
#include "dfdyn/control/forecast_comparison.hpp"
#include "dfdyn/control/reference.hpp"
#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdint>

namespace dfdyn {

/// A learner that `FeedForward` can use; `LearnedTorque` documents the calls. `predict` writes
/// `forecast_count()` forecasts of n torques, one after the other; NaN marks an unknown forecast.
template <class L>
concept TorqueLearner = requires(L learner, std::int64_t time_ns, const typename L::Scalar* values,
                                 typename L::Scalar* torque) {
    { L::outputs } -> std::convertible_to<int>;
    { L::forecasts } -> std::convertible_to<int>;
    learner.begin(time_ns, values);
    learner.learn(time_ns, values, values);
    learner.go_on();
    { learner.predict(time_ns, values, torque) } -> std::same_as<bool>;
    {
        int { learner.forecast_count() }
        } -> std::same_as<int>;
};

/// Feed-forward torque for a reference: a blend of the caller's nominal torque and a learned torque.
///
/// Once per sample period of its model (a *knot*) the learner predicts the torque at the next knot: one or
/// more forecasts, for the reference extrapolated at constant acceleration. Between knots the torque is
/// interpolated. Once per knot `commanded` compares the nominal torque and all forecasts of a joint with its
/// commanded torque. `ForecastCombination` weights them by their errors over the last `memory_s`. The command
/// contains the feedback, so the comparison includes the tracking error and needs no torque sensor. Errors
/// that are too fast for the feedback do not appear in the command and are not detected. Until `memory_s` of
/// comparisons of a joint is available, only its nominal torque is used.
///
/// A `DisturbanceObserver` compensates slow errors of a forecast; fast ones remain as tracking error. Each
/// error is therefore high-pass filtered with the observer's bandwidth before it is compared: its slow part,
/// up to the observer's limit, counts with the share `slow_share` only. Errors are clipped to ± `limit`, and
/// slow parts decay while the joint is not compared. An absurd forecast is thus forgotten within the memory.
///
/// An unknown forecast is left out. In the comparison it counts as the nominal torque, so it gains no weight;
/// a forecast that was never known starts with the weight of the nominal torque. The known forecasts replace
/// it at once. Each then has the excess of its weight over the nominal torque's, at least 0. Forecasts are
/// clipped to ± `limit`.
///
/// The learned part changes without steps: its share rises within `rise_s` and falls within `fall_s`. The
/// shares of the forecasts in it change within `fall_s`. The learned part adds at most `cap` to the nominal
/// torque and changes at most at `rate`. The total stays within `limit`.
///
///     begin(now, position);                              // the arm rests at the reference's start
///     each control tick:
///         torque = update(reference, nominal) + feedback + observer;
///         observer_bandwidth_share(k, observer.share()[k]);      // of each joint
///         commanded(torque);                                     // NaN for a joint that a limit changed
///         measured(time, position, torque that was in effect then);   // nullptr if unknown
///
/// Learn from the command that was in effect when the position was read rather than from a torque sensor:
/// offset and scale errors of a sensor then have no effect. Cost per tick: the learner's cost plus `cost()`.
template <TorqueLearner Learner>
class FeedForward {
  public:
    using Scalar = typename Learner::Scalar;   ///< float or double
    static constexpr int n = Learner::outputs; ///< joints; each has one torque
    using Torques = Storage<Scalar, n>;        ///< n values, N·m (N for prismatic joints)
    /// Number of forecasts of the learner, each with n torques.
    static constexpr int forecasts = Learner::forecasts;

    using Settings = FeedForwardSettings<Scalar, n>; ///< limits and times

    /// Lead of the interpolation, ticks. A command is held for a tick, so on average it acts half a tick
    /// late. A learned torque was held, on average, half a tick before its position was read.
    static constexpr Scalar lead = 1;

    /// Refers to `learner`, which must outlive this object; copies `settings`. Call `begin` before the first
    /// `update`. Settings outside their ranges give no torque at all: see `settings_valid`.
    explicit FeedForward(Learner& learner, const Settings& settings) noexcept
        : learner_(&learner), joints_(learner.output_count()), forecast_count_(learner.forecast_count()),
          settings_valid_(settings.valid(joints_)),
          settings_(settings_valid_ ? settings : Settings::no_torque(joints_)),
          comparison_(forecast_count_, joints_, settings_),
          from_(Forecasts::zeros(extent<product(forecasts, n)>(forecast_count_ * joints_))), to_(from_),
          mix_(from_), ahead_(Torques::zeros(joints_)), share_(ahead_), part_(ahead_), torque_(ahead_),
          nominal_(ahead_) {
        for (int k = 0; k < joints_; ++k) {
            observer_bandwidth_share(k, Scalar(1));
        }
    }

    /// Takes what vibrations left of the observer's `bandwidth` at joint `k`, 0 … 1; initially 1:
    /// `DisturbanceObserver::share()`. Other values are ignored. `begin` keeps it. Cost: 4 multiplications.
    void observer_bandwidth_share(int k, Scalar share) noexcept {
        if (share >= 0 && share <= 1) {
            comparison_.follow(k, share * settings_.bandwidth[k], settings_);
        }
    }

    /// Returns whether all settings are finite and within their ranges. If not, torques and shares stay 0.
    [[nodiscard]] bool settings_valid() const noexcept { return settings_valid_; }

    /// Starts a motion at `time_ns` from rest at `position` (n values, rad). Keeps what was learned.
    void begin(std::int64_t time_ns, const Scalar* position) noexcept {
        knot_ns_ = time_ns;
        tick_ = 0;
        since_knot_ = -1;
        sample_tick_ = 0;
        sample_lost_ = false;
        comparison_.restart();
        learner_->begin(time_ns, position);
        for (int k = 0; k < joints_; ++k) {
            share_[k] = part_[k] = nominal_[k] = 0;
        }
        std::fill(mix_.begin(), mix_.end(), Scalar(1) / static_cast<Scalar>(int{forecast_count_}));
        known_ = next_known_ = false;
    }

    /// Includes or excludes the learned part in the torque, without a step. Learning continues in both cases.
    void enable(bool on) noexcept { enabled_ = on; }
    /// Returns whether the learned part is included. Initially true.
    [[nodiscard]] bool enabled() const noexcept { return enabled_; }

    /// Returns the feed-forward torque of this tick, n values, N·m, within ± `limit`. `reference`: one tick
    /// later than that of the last call, also after a lost cycle: the learner's window of the reference
    /// counts calls, and a jump in it would be predicted as an acceleration. `nominal`: torque of your own
    /// model for it, n values, N·m; zeros without a model. A NaN or infinite one is replaced by the joint's
    /// last finite one, to avoid a step; by 0 before the first.
    const Torques& update(const Reference<Scalar, n>& reference, const Scalar* nominal) noexcept {
        since_knot_ = static_cast<int>(tick_++ % settings_.ticks_per_sample);
        if (since_knot_ == 0) {
            go_to_next_knot(reference);
        }
        way_ = std::min((static_cast<Scalar>(since_knot_) + lead) /
                            static_cast<Scalar>(settings_.ticks_per_sample),
                        Scalar(1));
        for (int k = 0; k < joints_; ++k) {
            nominal_[k] = bounded(std::isfinite(nominal[k]) ? nominal[k] : nominal_[k], settings_.limit[k]);
            torque_[k] = with_learned(k, nominal_[k]);
        }
        return torque_;
    }

    /// Compares the forecasts with the torque commanded in this tick (n values, N·m). Call it in every tick,
    /// after `update`. Each joint is compared once per knot, in the first tick with its command. NaN or
    /// infinite: the joint is not compared in this tick. Pass NaN for a joint whose command differs from the
    /// torque that the motion requires: at a limit, or while its positions are missing.
    void commanded(const Scalar* torque) noexcept {
        if (!known_ || !next_known_) {
            return;
        }
        comparison_.compare(torque, settings_, [this](int i) {
            const Scalar nominal = nominal_[i % joints_];
            const Scalar forecast = i < joints_ ? nominal : at_present(i - joints_);
            return std::isfinite(forecast) ? forecast : nominal; // an unknown one gains no weight
        });
    }

    /// Passes the newest measured position (n values, rad) and the torque that was in effect at that time (n
    /// values, N·m); nullptr if unknown. Call it in every tick, after `update`: a sample is taken once per
    /// sample period, and learning continues in between. `time_ns`: stamp of the measurement, by the clock of
    /// `begin`; `SampleClock` documents the permitted jitter. `position`: nullptr if there is no new one.
    ///
    /// Samples are taken at the knots. A sample whose position is missing is lost, and learning waits until
    /// the window of the measured motion is full again. From the next period on, samples are taken in the
    /// tick of the period in which the next position came. The samples of a window are therefore always one
    /// period apart, and encoders that give a position every so many ticks may have any phase, if that
    /// number divides `ticks_per_sample`.
    void measured(std::int64_t time_ns, const Scalar* position, const Scalar* torque) noexcept {
        const bool due = since_knot_ == sample_tick_;
        if (due && position != nullptr) {
            learner_->learn(time_ns, position, torque);
        } else {
            learner_->go_on();
        }
        if (due) {
            sample_lost_ = position == nullptr;
        } else if (sample_lost_ && position != nullptr) {
            sample_tick_ = since_knot_;
            sample_lost_ = false;
        }
    }

    /// Returns the share of the learned forecast in each joint's torque, 0 … 1.
    [[nodiscard]] const Torques& share() const noexcept { return share_; }

    /// Combines other forecasts (`forecast_count()` × n values, N·m) and another `nominal` torque (n values,
    /// N·m) with the present weights and shares into `torque` (n values, N·m). Example: forecasts for the arm
    /// at rest, to hold it after a stop. Unknown forecasts are NaN; without a known one the result is the
    /// nominal torque.
    void combine(const Scalar* other, const Scalar* nominal, Scalar* torque) const noexcept {
        for (int k = 0; k < joints_; ++k) {
            const Scalar known_nominal = bounded(nominal[k], settings_.limit[k]);
            const Learned learned = combined(k, [other](int i) { return other[i]; });
            torque[k] = bounded(known_nominal + added(k, learned, known_nominal), settings_.limit[k]);
        }
    }

    /// Returns the learned part of the present torque, N·m.
    [[nodiscard]] const Torques& learned_part() const noexcept { return part_; }
    /// Returns the learner, for its counters and snapshots.
    [[nodiscard]] const Learner& learner() const noexcept { return *learner_; }

    /// Returns the maximum multiply-adds of `update` and `commanded` in a tick, without the learner's.
    /// `at_knot`: true for a tick with a knot, and for one that compares a joint that was not compared at the
    /// knot; false for the others.
    [[nodiscard]] std::int64_t cost(bool at_knot) const noexcept {
        const std::int64_t of_learner = from_.size();
        const std::int64_t between = 1 + 10 * joints_ + 6 * of_learner;
        return between + (at_knot ? 5 * joints_ + of_learner + comparison_.cost() : 0);
    }

  private:
    using Forecasts = Storage<Scalar, product(forecasts, n)>;
    using Comparison = ForecastComparison<Scalar, forecasts, n>;

    static Scalar bounded(Scalar value, Scalar limit) noexcept { return Comparison::bounded(value, limit); }

    /// Returns element `i` of the forecasts, interpolated for the present tick.
    [[nodiscard]] Scalar at_present(int i) const noexcept { return from_[i] + way_ * (to_[i] - from_[i]); }

    void go_to_next_knot(const Reference<Scalar, n>& reference) noexcept {
        comparison_.begin_knot();
        knot_ns_ += settings_.period_ns * settings_.ticks_per_sample;
        for (int k = 0; k < joints_; ++k) {
            ahead_[k] = position_after(reference, k, settings_.sample_period_s());
        }
        from_ = to_;
        known_ = next_known_;
        next_known_ = learner_->predict(knot_ns_, ahead_.data(), to_.data());
    }

    /// Combination of the known forecasts of a joint.
    struct Learned {
        Scalar torque; ///< N·m
        Scalar earned; ///< share by the comparison, 0 … 1; the rest is the nominal torque's
        bool complete; ///< all forecasts are known
    };

    /// Combines the finite forecasts `value(i)` of joint `k`. If any is unknown, each of the others has the
    /// excess of its weight over the nominal torque's, at least 0.
    template <class Value>
    [[nodiscard]] Learned combined(int k, const Value& value) const noexcept {
        const Scalar* const weights = comparison_.weights();
        Learned all{Scalar(0), 1 - weights[k], true};
        Scalar sum = 0;
        Scalar total = 0;
        for (int i = k; i < mix_.size(); i += joints_) {
            const Scalar given = value(i);
            if (!std::isfinite(given)) {
                all.complete = false;
                continue;
            }
            const Scalar forecast = std::clamp(given, -settings_.limit[k], settings_.limit[k]);
            const Scalar beyond = std::max(Scalar(0), weights[joints_ + i] - weights[k]);
            all.torque += mix_[i] * forecast;
            sum += beyond * forecast;
            total += beyond;
        }
        if (all.complete) {
            return all;
        }
        return total > 0 ? Learned{sum / total, total / (total + weights[k]), false} : Learned{0, 0, false};
    }

    /// Returns the torque that `learned` adds to joint `k`'s nominal torque. The share changes slowly. If
    /// forecasts are unknown, it is limited at once to what the known ones earned.
    [[nodiscard]] Scalar added(int k, const Learned& learned, Scalar nominal) const noexcept {
        const Scalar share = learned.complete ? share_[k] : std::min(share_[k], learned.earned);
        return share * bounded(learned.torque - nominal, settings_.cap[k]);
    }

    /// Moves the forecasts' shares within the learned part of joint `k` towards their weights.
    void mix(int k) noexcept {
        const Scalar* const earned = comparison_.weights() + joints_;
        Scalar total = 0;
        Scalar farthest = 0;
        for (int i = k; i < mix_.size(); i += joints_) {
            total += earned[i];
        }
        for (int i = k; total > 0 && i < mix_.size(); i += joints_) {
            farthest = std::max(farthest, Scalar(std::abs(earned[i] / total - mix_[i])));
        }
        const Scalar step = std::min(Scalar(1), settings_.period_s() / settings_.fall_s / farthest);
        for (int i = k; farthest > 0 && i < mix_.size(); i += joints_) {
            mix_[i] += step * (earned[i] / total - mix_[i]);
        }
    }

    Scalar with_learned(int k, Scalar nominal) noexcept {
        mix(k);
        const Learned learned = combined(k, [this](int i) { return at_present(i); });
        const bool known = known_ && next_known_;
        const Scalar earned = enabled_ && known && comparison_.judged(k) ? learned.earned : Scalar(0);
        share_[k] += std::clamp(earned - share_[k], -settings_.period_s() / settings_.fall_s,
                                settings_.period_s() / settings_.rise_s);
        const Scalar most = settings_.rate[k] * settings_.period_s();
        const Scalar wanted = known ? added(k, learned, nominal) : Scalar(0);
        part_[k] += std::clamp(wanted - part_[k], -most, most);
        return bounded(nominal + part_[k], settings_.limit[k]);
    }

    Learner* learner_;
    [[no_unique_address]] Extent<n> joints_;
    [[no_unique_address]] Extent<forecasts> forecast_count_;
    bool settings_valid_;
    Settings settings_;
    Comparison comparison_;
    Forecasts from_, to_; ///< forecasts for the present and for the next knot
    Forecasts mix_;       ///< shares of the forecasts in the learned part
    Torques ahead_;
    Torques share_, part_, torque_;
    Torques nominal_;          ///< the last finite one, within the limit
    Scalar way_ = 0;           ///< from the present to the next knot, of the interpolation
    std::int64_t knot_ns_ = 0; ///< time of the next knot
    std::int64_t tick_ = 0;
    int since_knot_ = -1; ///< ticks
    int sample_tick_ = 0; ///< ticks from a knot to its sample
    bool enabled_ = true;
    bool known_ = false, next_known_ = false; ///< whether the learner could predict each of the two knots
    bool sample_lost_ = false;                ///< its position was missing, and no later one has arrived
};

} // namespace dfdyn
