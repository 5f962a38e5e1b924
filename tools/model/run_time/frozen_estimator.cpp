// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/frozen_estimator.hpp"

#include "tools/model/run_time/estimator_decorator.hpp"

#include <utility>

namespace dfdyn::tools {

namespace {

class FrozenEstimator final : public EstimatorDecorator<RuntimeEstimator> {
  public:
    using EstimatorDecorator::EstimatorDecorator;

    Tick tick(const MeasuredSample& sample, Budget /*budget*/) override {
        return estimator().tick(sample, Budget::predict_only());
    }
    bool advance(Budget /*budget*/) override { return estimator().advance(Budget::predict_only()); }
    void relearn() override {}
    Cost cost() const override {
        Cost cost = estimator().cost();
        cost.learn = cost.forget = cost.largest_step = 0;
        return cost;
    }
};

} // namespace

std::unique_ptr<RuntimeEstimator> frozen(std::unique_ptr<RuntimeEstimator> estimator) {
    return std::make_unique<FrozenEstimator>(std::move(estimator));
}

} // namespace dfdyn::tools
