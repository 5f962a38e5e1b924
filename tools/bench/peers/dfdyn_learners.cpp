// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/learner/ud_covariance.hpp"
#include "tools/bench/peers/typed_learner.hpp"
#include "tools/bench/timing/whole_tick.hpp"

#include <memory>
#include <stdexcept>

namespace dfdyn::tools {

namespace {

template <class Scalar, int p>
class DfdynLearner final : public TypedLearner<Scalar> {
    using Base = TypedLearner<Scalar>;

  public:
    explicit DfdynLearner(const RegressionTask& task)
        : Base("dfdyn", BenchLearner::Kind::ours, task),
          learner_(std::make_unique<Learner>(constants, Extent<p>{}, Extent<RegressionTask::outputs>{})) {}

  private:
    using Learner = UdCovariance<Scalar, p, RegressionTask::outputs>;

    void learn(const Scalar* row, const Scalar* targets) override {
        whole_tick(*learner_, targets, row);
        keep(learner_->last_variance_ratio());
    }
    void predict(const Scalar* row, Scalar* means) override { learner_->predict(row, means); }

    static constexpr
        typename Learner::Constants constants{Scalar(RegressionTask::prior_variance), 1, nullptr};
    std::unique_ptr<Learner> learner_;
};

template <int p, class... Scalar>
BenchLearners of_size(const RegressionTask& task) {
    BenchLearners all;
    (all.push_back(std::make_unique<DfdynLearner<Scalar, p>>(task)), ...);
    return all;
}

} // namespace

const std::vector<int>& learner_columns() {
    static const std::vector<int> sizes{100, 200, 500, 1000, 2000};
    return sizes;
}

BenchLearners dfdyn_learners(const RegressionTask& task) {
    switch (task.columns()) {
    case 100:
        return of_size<100, float, double>(task);
    case 200:
        return of_size<200, float, double>(task);
    case 500:
        return of_size<500, float, double>(task);
    case 1000:
        return of_size<1000, float, double>(task);
    case 2000:
        return of_size<2000, float>(task); // in double it would not fit into the caches
    default:
        throw std::logic_error("a size of benchmark that was not compiled");
    }
}

} // namespace dfdyn::tools
