// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/frozen_estimator.hpp"

#include <utility>

namespace dfdyn::tools {

namespace {

class FrozenEstimator final : public HostEstimator {
  public:
    explicit FrozenEstimator(std::unique_ptr<HostEstimator> estimator) : estimator_(std::move(estimator)) {}

    Tick tick(const MeasuredSample& sample, Budget /*budget*/) override {
        return estimator_->tick(sample, Budget::predict_only());
    }
    bool advance(Budget /*budget*/) override { return estimator_->advance(Budget::predict_only()); }
    bool predict_with(std::span<const float> weights, std::span<float> prediction) const override {
        return estimator_->predict_with(weights, prediction);
    }
    std::size_t weight_count() const override { return estimator_->weight_count(); }
    void copy_weights(std::span<float> weights) const override { estimator_->copy_weights(weights); }
    void begin_recording() override { estimator_->begin_recording(); }
    std::vector<std::byte> snapshot() const override { return estimator_->snapshot(); }
    bool restore(std::span<const std::byte> snapshot) override { return estimator_->restore(snapshot); }
    std::size_t state_bytes() const override { return estimator_->state_bytes(); }
    Cost cost() const override {
        Cost cost = estimator_->cost();
        cost.learn = cost.forget = cost.largest_step = 0;
        return cost;
    }

  private:
    std::unique_ptr<HostEstimator> estimator_;
};

} // namespace

std::unique_ptr<HostEstimator> frozen(std::unique_ptr<HostEstimator> estimator) {
    return std::make_unique<FrozenEstimator>(std::move(estimator));
}

} // namespace dfdyn::tools
