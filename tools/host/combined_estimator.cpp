// SPDX-License-Identifier: Apache-2.0
#include "tools/host/combined_estimator.hpp"

#include "dfdyn/forecast_combination.hpp"
#include "tools/host/dynamic_storage.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

using Members = std::vector<CombinationMember>;

class CombinedEstimator final : public HostEstimator {
  public:
    CombinedEstimator(Members members, std::size_t outputs)
        : members_(std::move(members)), outputs_(outputs),
          combination_(Extent<dynamic>{static_cast<int>(members_.size())},
                       Extent<dynamic>{static_cast<int>(outputs)}, combination_memory),
          predictions_(members_.size() * outputs), deviations_(predictions_.size()), measured_(outputs),
          prediction_(outputs), deviation_(outputs) {}

    Tick tick(const MeasuredSample& sample, Budget budget) override {
        Tick all = tick_members(sample, budget);
        combination_.combine(predictions_.data(), prediction_.data());
        combination_.combine(deviations_.data(), deviation_.data());
        if (all.status.learned()) {
            std::ranges::transform(sample.output, measured_.begin(),
                                   [](double y) { return static_cast<float>(y); });
            combination_.learn(predictions_.data(), measured_.data());
        }
        all.prediction = prediction_;
        all.standard_deviation = deviation_;
        return all;
    }

    bool advance(Budget budget) override {
        bool idle = true;
        for (const CombinationMember& member : members_) {
            idle = member.estimator->advance(budget) && idle;
        }
        return idle;
    }

    void predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        std::span<const float> rest = weights.subspan(predictions_.size());
        std::vector<float> of_member(outputs_);
        std::ranges::fill(prediction, 0.0F);
        for (std::size_t j = 0; j < members_.size(); ++j) {
            members_[j].estimator->predict_with(rest.first(members_[j].estimator->weight_count()), of_member);
            rest = rest.subspan(members_[j].estimator->weight_count());
            for (std::size_t k = 0; k < outputs_; ++k) {
                prediction[k] += weights[j * outputs_ + k] * of_member[k];
            }
        }
    }

    /// Those of the combination, then those of each member.
    std::size_t weight_count() const override {
        return sum_over_members([](const HostEstimator& member) { return member.weight_count(); },
                                predictions_.size());
    }
    void copy_weights(std::span<float> weights) const override {
        std::copy_n(combination_.weights(), predictions_.size(), weights.begin());
        std::span<float> rest = weights.subspan(predictions_.size());
        for (const CombinationMember& member : members_) {
            member.estimator->copy_weights(rest.first(member.estimator->weight_count()));
            rest = rest.subspan(member.estimator->weight_count());
        }
    }

    void begin_recording() override {
        std::ranges::for_each(members_,
                              [](CombinationMember& member) { member.estimator->begin_recording(); });
    }

    /// That of the combination, then those of each member.
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
        return restored;
    }

    std::size_t state_bytes() const override {
        return sum_over_members([](const HostEstimator& member) { return member.state_bytes(); },
                                combination_.snapshot_bytes());
    }

    Cost cost() const override {
        const auto table = static_cast<std::int64_t>(predictions_.size());
        Cost cost{.predict = 2 * table, .variance = 0, .learn = 8 * table, .forget = 0, .largest_step = 0};
        for (const CombinationMember& member : members_) {
            const Cost one = member.estimator->cost();
            cost.predict += one.predict;
            cost.variance += one.variance;
            cost.learn += one.learn;
            cost.forget += one.forget;
            cost.largest_step = std::max(cost.largest_step, one.largest_step);
        }
        return cost;
    }

  private:
    /// The members' ticks, their predictions put into the tables; without prediction of the combination.
    Tick tick_members(const MeasuredSample& sample, Budget budget) {
        Tick all;
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
            if (all.status.prediction == Reason::ok) {
                all.status.prediction = one.status.prediction;
            }
            if (all.status.learning == Reason::ok) {
                all.status.learning = one.status.learning;
            }
        }
        return all;
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
    ForecastCombination<float, dynamic, dynamic> combination_;
    std::vector<float> predictions_, deviations_; ///< members × outputs
    std::vector<float> measured_, prediction_, deviation_;
};

} // namespace

std::unique_ptr<HostEstimator> combine(Members members, std::size_t outputs) {
    return std::make_unique<CombinedEstimator>(std::move(members), outputs);
}

} // namespace dfdyn::tools
