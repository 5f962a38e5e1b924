// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/combined_estimator.hpp"

#include "dfdyn/forecast_combination.hpp"
#include "dfdyn/monitor/delayed_weights.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

using Members = std::vector<CombinationMember>;
using Combination = ForecastCombination<float, dynamic, dynamic>;

/// Noise standard deviations of all members, in their order.
std::vector<float> noise_of(const Members& members) {
    std::vector<float> noise;
    for (const CombinationMember& member : members) {
        std::ranges::transform(member.noise_std, std::back_inserter(noise),
                               [](double x) { return static_cast<float>(x); });
    }
    return noise;
}

/// Returns the variance factor before any error is known: the one of the paper's deviations unless all
/// members are calibrated.
float unjudged_factor_of(const Members& members) {
    return std::ranges::all_of(members, &CombinationMember::calibrated)
               ? Combination::calibrated_variance_factor
               : Combination::variance_factor;
}

bool refused(Reason learning) { return learning == Reason::output_missing || is_fault(learning); }

class CombinedEstimator final : public RuntimeEstimator {
  public:
    CombinedEstimator(Members members, std::size_t outputs, double sample_period_s)
        : members_(std::move(members)), outputs_(outputs),
          combination_(Extent<dynamic>{static_cast<int>(members_.size())},
                       Extent<dynamic>{static_cast<int>(outputs)},
                       static_cast<float>(combination_memory_s / sample_period_s), noise_of(members_).data(),
                       unjudged_factor_of(members_)),
          period_(std::max(1L, std::lround(held_weights_period_s / sample_period_s))),
          predictions_(members_.size() * outputs), ahead_(predictions_.size()),
          deviations_(predictions_.size()), measured_(outputs), prediction_(outputs), deviation_(outputs) {
        for (const CombinationMember& member : members_) {
            held_.emplace_back(Extent<dynamic>{static_cast<int>(member.estimator->weight_count())});
        }
        hold_all();
    }

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        auto [all, refused_by_all] = tick_members(sample, budget);
        if (all.status.estimated()) {
            combination_.weigh(deviations_.data());
            combination_.combine(predictions_.data(), prediction_.data());
            combination_.combine(deviations_.data(), deviation_.data());
            if (!sample.output.empty() && !refused_by_all && budget.operations > 0) {
                learn(sample.output);
            } else {
                combination_.skip();
            }
        } else {
            std::ranges::fill(prediction_, 0.0F);
            std::ranges::fill(deviation_, std::numeric_limits<float>::infinity());
        }
        ++since_held_;
        hold_when_due();
        all.prediction = prediction_;
        all.standard_deviation = deviation_;
        return all;
    }

    bool advance(Budget budget) override {
        bool idle = true;
        for (const CombinationMember& member : members_) {
            idle = member.estimator->advance(budget) && idle;
        }
        hold_when_due();
        return idle;
    }

    /// Returns false if every member exceeded a bound, as in `tick`.
    bool predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        bool within = false;
        std::span<const float> rest = weights.subspan(predictions_.size());
        std::vector<float> of_members(predictions_.size());
        std::vector<float> combined(predictions_.size());
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const RuntimeEstimator& member = *members_[j].estimator;
            const std::span<float> of_member = std::span(of_members).subspan(j * outputs_, outputs_);
            within = member.predict_with(rest.first(member.weight_count()), of_member) || within;
            rest = rest.subspan(member.weight_count());
        }
        combination_.weigh(weights.data(), deviations_.data(), combined.data());
        combination_.combine(combined.data(), of_members.data(), prediction.data());
        return within;
    }

    /// Number of the combination's mean square errors plus the members' weights.
    std::size_t weight_count() const override {
        return sum_over_members([](const RuntimeEstimator& member) { return member.weight_count(); },
                                predictions_.size());
    }
    void copy_weights(std::span<float> weights) const override {
        combination_.copy_mean_squares(weights.data());
        std::span<float> rest = weights.subspan(predictions_.size());
        for (const CombinationMember& member : members_) {
            member.estimator->copy_weights(rest.first(member.estimator->weight_count()));
            rest = rest.subspan(member.estimator->weight_count());
        }
    }

    void relearn() override {
        for (CombinationMember& member : members_) {
            member.estimator->relearn();
        }
    }
    void begin_recording() override {
        std::ranges::for_each(members_,
                              [](CombinationMember& member) { member.estimator->begin_recording(); });
        hold_all(); // the time since the last recording is unknown
    }

    /// Returns the combination's snapshot, followed by those of the members.
    std::vector<std::byte> snapshot() const override {
        std::vector<std::byte> bytes(combination_.snapshot_bytes());
        if (combination_.snapshot(bytes) != SnapshotResult::ok) {
            throw std::logic_error("a combination that its own snapshot does not hold");
        }
        for (const CombinationMember& member : members_) {
            std::ranges::copy(member.estimator->snapshot(), std::back_inserter(bytes));
        }
        return bytes;
    }

    bool restore(std::span<const std::byte> bytes) override {
        if (bytes.size() != state_bytes()) {
            return false;
        }
        const std::vector<std::byte> before = snapshot();
        const bool restored = restore_parts(bytes);
        if (!restored) {
            restore_parts(before);
        }
        hold_all();
        return restored;
    }

    std::size_t state_bytes() const override {
        return sum_over_members([](const RuntimeEstimator& member) { return member.state_bytes(); },
                                combination_.snapshot_bytes());
    }

    /// Includes the members' predictions with held weights.
    Cost cost() const override {
        Cost cost = Combination::cost(Extent<dynamic>{static_cast<int>(members_.size())},
                                      Extent<dynamic>{static_cast<int>(outputs_)});
        for (const CombinationMember& member : members_) {
            const Cost one = member.estimator->cost();
            cost.predict += 2 * one.predict;
            cost.variance += one.variance;
            cost.learn += one.learn;
            cost.forget += one.forget;
            cost.reset_covariance += one.reset_covariance;
            cost.largest_step = std::max(cost.largest_step, one.largest_step);
        }
        return cost;
    }

  private:
    /// Runs the members' ticks and stores their predictions in the tables, without the combination's
    /// prediction. Returns the tick, and whether every member rejected the sample.
    std::pair<Tick, bool> tick_members(const MeasuredSample& sample, Budget budget) {
        Tick all;
        bool refused_by_all = true;
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const Tick one = members_[j].estimator->tick(sample, budget);
            const auto row = static_cast<std::ptrdiff_t>(j * outputs_);
            std::ranges::copy(one.prediction, predictions_.begin() + row);
            std::ranges::copy(one.standard_deviation, deviations_.begin() + row);
            const float innovation =
                one.normalised_innovation_squared *
                static_cast<float>(members_.front().innovation_limit / members_[j].innovation_limit);
            all.normalised_innovation_squared =
                j == 0 ? innovation : std::min(all.normalised_innovation_squared, innovation);
            all.duration += one.duration;
            refused_by_all = refused_by_all && refused(one.status.learning);
            if (all.status.estimated() && (j == 0 || one.status.prediction != Reason::prediction_bounded)) {
                all.status.prediction = one.status.prediction; // within the bounds only if all members are
            }
            if (all.status.learning == Reason::ok) {
                all.status.learning = one.status.learning;
            }
        }
        return {all, refused_by_all};
    }

    /// Updates the combination with the members' predictions of the sample of the last tick.
    void learn(std::span<const double> output) {
        std::ranges::transform(output, measured_.begin(), [](double y) { return static_cast<float>(y); });
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const RuntimeEstimator& member = *members_[j].estimator;
            member.predict_with({held_[j].older(), member.weight_count()},
                                std::span(ahead_).subspan(j * outputs_, outputs_));
        }
        combination_.learn(predictions_.data(), ahead_.data(), measured_.data());
    }

    /// Sets both copies to the members' present weights.
    void hold_all() {
        for (int copy = 0; copy < 2; ++copy) {
            hold();
        }
        since_held_ = 0;
    }

    void hold() {
        for (std::size_t j = 0; j < members_.size(); ++j) {
            const RuntimeEstimator& member = *members_[j].estimator;
            member.copy_weights({held_[j].refresh(), member.weight_count()});
        }
    }

    /// Copies the weights once per period, as soon as no member has work left.
    void hold_when_due() {
        const auto idle = [](CombinationMember& member) {
            return member.estimator->advance(Budget::predict_only());
        };
        if (since_held_ >= period_ && std::ranges::all_of(members_, idle)) {
            hold();
            since_held_ = 0;
        }
    }

    bool restore_parts(std::span<const std::byte> bytes) {
        if (combination_.restore(bytes.first(combination_.snapshot_bytes())) != SnapshotResult::ok) {
            return false;
        }
        bytes = bytes.subspan(combination_.snapshot_bytes());
        return std::ranges::all_of(members_, [&bytes](CombinationMember& member) {
            const std::span<const std::byte> part = bytes.first(member.estimator->state_bytes());
            bytes = bytes.subspan(part.size());
            return member.estimator->restore(part);
        });
    }

    template <class Size>
    std::size_t sum_over_members(const Size& size, std::size_t sum) const {
        for (const CombinationMember& member : members_) {
            sum += size(*member.estimator);
        }
        return sum;
    }

    Members members_;
    std::size_t outputs_;
    Combination combination_;
    long period_;         ///< between two copies of the weights, samples
    long since_held_ = 0; ///< samples
    std::vector<DelayedWeights<float, dynamic>> held_;
    std::vector<float> predictions_, ahead_, deviations_; ///< members × outputs
    std::vector<float> measured_, prediction_, deviation_;
};

} // namespace

std::unique_ptr<RuntimeEstimator> combine(Members members, std::size_t outputs, double sample_period_s) {
    return std::make_unique<CombinedEstimator>(std::move(members), outputs, sample_period_s);
}

} // namespace dfdyn::tools
