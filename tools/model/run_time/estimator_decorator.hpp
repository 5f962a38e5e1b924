// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/runtime_estimator.hpp"

#include <memory>
#include <utility>

namespace dfdyn::tools {

/// An estimator that changes or observes another one. `Interface`: RuntimeEstimator, or one derived from it.
/// Every function forwards to the other estimator; derived classes override those that differ.
template <class Interface>
class EstimatorDecorator : public Interface {
  public:
    explicit EstimatorDecorator(std::unique_ptr<RuntimeEstimator> estimator)
        : estimator_(std::move(estimator)) {}

    using RuntimeEstimator::tick;
    Tick tick(const MeasuredSample& sample, Budget budget) override {
        return estimator_->tick(sample, budget);
    }
    bool advance(Budget budget) override { return estimator_->advance(budget); }
    bool predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        return estimator_->predict_with(weights, prediction);
    }
    std::size_t weight_count() const override { return estimator_->weight_count(); }
    void copy_weights(std::span<float> weights) const override { estimator_->copy_weights(weights); }
    void relearn() override { estimator_->relearn(); }
    void begin_recording() override { estimator_->begin_recording(); }
    std::vector<std::byte> snapshot() const override { return estimator_->snapshot(); }
    bool restore(std::span<const std::byte> snapshot) override { return estimator_->restore(snapshot); }
    std::size_t state_bytes() const override { return estimator_->state_bytes(); }
    Cost cost() const override { return estimator_->cost(); }

  protected:
    RuntimeEstimator& estimator() { return *estimator_; }
    const RuntimeEstimator& estimator() const { return *estimator_; }

  private:
    std::unique_ptr<RuntimeEstimator> estimator_;
};

} // namespace dfdyn::tools
