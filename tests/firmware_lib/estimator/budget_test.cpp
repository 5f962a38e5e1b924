// SPDX-License-Identifier: Apache-2.0
// Ticks with a small budget: learning is spread over several ticks, with the same result.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>

namespace estimator_budget_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using UdFloat = TestModel<float, DerivativeFreeReduced<6, 3>, 15>;
using UdDouble = TestModel<double, DerivativeFreeReduced<6, 3>, 15>;
using Parametric = TestParametric<float>;
using ParametricDouble = TestParametric<double, StandardMeasured>;
using Mean = TestMean<float, DerivativeFreeReduced<6, 3>, 15>;
using Kernel = TestKernel<float, DerivativeFreeReduced<6, 3>, 15>;
using KernelDouble = TestKernel<double, DerivativeFree<6>, 15, StandardMeasured>;

template <class Model>
constexpr Cost cost_of() {
    return Estimator<Model>::cost();
}

/// Returns true if this tick began to learn its sample, at once or in slices.
bool taken(const Status& status) {
    return status.predicted() &&
           (status.learning == Reason::ok || status.learning == Reason::learning_in_progress);
}

template <class Scalar, int m>
double largest_difference(const Storage<Scalar, m>& a, const Storage<Scalar, m>& b) {
    double largest = 0;
    for (int k = 0; k < a.size(); ++k) {
        largest = std::max(largest, std::abs(static_cast<double>((a[k] - b[k]) / b[k])));
    }
    return largest;
}

// The estimator without slicing learns exactly the samples that the sliced one began to learn.
TEMPLATE_TEST_CASE("random budgets learn the same as unlimited ones, bit for bit", "", UdFloat, UdDouble,
                   Parametric, ParametricDouble, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine, 0.99);
    Estimator<TestType> sliced(constants);
    Estimator<TestType> whole(constants);
    std::uniform_int_distribution<std::int64_t> operations(0, cost_of<TestType>().learn * 3 / 2);
    int compared = 0;
    int different = 0;
    for (int t = 0; t < 3000; ++t) {
        auto sample = moving_sample<TestType>(t, engine);
        const bool to_the_end = t % 10 == 9;
        const auto estimate =
            sliced.tick(sample, to_the_end ? Budget::unlimited() : Budget{operations(engine)});
        sample.output_valid = taken(estimate.status);
        whole.tick(sample, Budget::unlimited());
        if (sliced.regression().idle()) {
            ++compared;
            different += weights_of(sliced) == weights_of(whole) ? 0 : 1;
        }
    }
    CHECK(compared >= 300);
    CHECK(different == 0);
    CHECK(sliced.counters().reasons[static_cast<int>(Reason::learner_busy)] > 300);
}

TEMPLATE_TEST_CASE("the estimates while a sample is being learned are those before it", "", UdFloat, UdDouble,
                   Mean) {
    DFDYN_SEEDED_ENGINE(engine);
    const double rounding = std::is_same_v<typename TestType::Scalar, float> ? 1e-4 : 1e-12;
    const auto constants = make_constants<TestType>(engine, 0.999);
    Estimator<TestType> estimator(constants);
    for (int t = 0; t < 50; ++t) {
        estimator.tick(moving_sample<TestType>(t, engine), Budget::unlimited());
    }
    estimator.tick(moving_sample<TestType>(50, engine), Budget{100'000}); // completes the pending sample
    Estimator<TestType> before = estimator;
    int busy = 0;
    for (int t = 51; t < 500; ++t) {
        auto sample = moving_sample<TestType>(t, engine);
        const bool idle = estimator.regression().idle();
        const auto estimate = estimator.tick(sample, Budget{cost_of<TestType>().largest_step / 3});
        sample.output_valid = false;
        const auto expected = before.tick(sample, Budget::unlimited());
        REQUIRE(same(estimate.prediction, expected.prediction));
        REQUIRE(largest_difference(estimate.standard_deviation, expected.standard_deviation) < rounding);
        busy += idle ? 0 : 1;
        REQUIRE(estimate.status.learning == (idle ? Reason::learning_in_progress : Reason::learner_busy));
        if (t % 60 == 0) { // complete it and choose another sample
            estimator.tick(moving_sample<TestType>(++t, engine), Budget::unlimited());
            before = estimator;
        }
    }
    CHECK(busy > 100);
}

TEMPLATE_TEST_CASE("samples that arrive while another is being learned are skipped and counted", "", UdFloat,
                   Parametric, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    std::uniform_int_distribution<std::int64_t> operations(0, 2 * cost_of<TestType>().learn);
    std::uint64_t begun = 0;
    for (int t = 0; t < 2000; ++t) {
        begun += taken(estimator.tick(moving_sample<TestType>(t, engine), Budget{operations(engine)}).status)
                     ? 1
                     : 0;
        const Counters& counters = estimator.counters();
        const auto count_of = [&](Reason reason) { return counters.reasons[static_cast<int>(reason)]; };
        REQUIRE(counters.ticks == static_cast<std::uint64_t>(t + 1));
        REQUIRE(counters.learned + (estimator.regression().sample_pending() ? 1 : 0) == begun);
        REQUIRE(begun == count_of(Reason::ok) + count_of(Reason::learning_in_progress));
        REQUIRE(counters.predicted == begun + count_of(Reason::learner_busy) + count_of(Reason::no_budget));
    }
    CHECK(begun > 200);
    CHECK(begun < 1900);
}

TEMPLATE_TEST_CASE("a budget of the largest step always makes progress, a smaller one never finishes", "",
                   UdFloat, UdDouble, Parametric, ParametricDouble, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> enough(constants);
    Estimator<TestType> too_little(constants);
    constexpr Cost cost = cost_of<TestType>();
    for (int t = 0; t < 500; ++t) {
        const auto sample = moving_sample<TestType>(t, engine);
        enough.tick(sample, Budget{cost.largest_step});
        too_little.tick(sample, Budget{cost.largest_step - 1});
    }
    const auto steps = static_cast<std::uint64_t>(2 * cost.learn / cost.largest_step + 1);
    CHECK(enough.counters().learned >= 494 / steps);
    CHECK(too_little.counters().learned == 0);
    CHECK(std::ranges::all_of(weights_of(too_little), [](auto weight) { return weight == 0; }));
}

TEMPLATE_TEST_CASE("without a budget a sample is predicted and not learned", "", UdFloat, Parametric, Mean,
                   Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    const auto before = snapshot_of(estimator);
    for (int t = 0; t < 20; ++t) {
        const Budget budget = t % 2 == 0 ? Budget::predict_only() : Budget{-5};
        const auto estimate = estimator.tick(moving_sample<TestType>(t, engine), budget);
        CHECK((t < 6 || estimate.status.reason() == Reason::no_budget));
        CHECK((t < 6 || std::isfinite(estimate.standard_deviation[0])));
    }
    CHECK((snapshot_of(estimator) == before));
    CHECK(estimator.counters().learned == 0);
}

TEMPLATE_TEST_CASE("ticks that are refused or have no output continue a pending sample", "", UdFloat,
                   Parametric, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    constexpr Cost cost = cost_of<TestType>();
    for (int t = 0; t <= 6; ++t) {
        estimator.tick(moving_sample<TestType>(t, engine), Budget{cost.largest_step - 1});
    }
    REQUIRE(estimator.regression().sample_pending());
    auto refused = moving_sample<TestType>(7, engine);
    refused.position[0] = 1e9F;
    estimator.tick(refused, Budget::unlimited());
    CHECK(estimator.regression().idle());
    CHECK(estimator.counters().learned == 1);
}

TEMPLATE_TEST_CASE("learning between ticks gives the same bits and stays within the budget", "", UdFloat,
                   UdDouble, Parametric, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine, 0.99);
    Estimator<TestType> sliced(constants);
    Estimator<TestType> whole(constants);
    constexpr Cost cost = cost_of<TestType>();
    std::uniform_int_distribution<std::int64_t> operations(cost.largest_step,
                                                           cost.largest_step + cost.learn / 4);
    int slices = 0;
    int different = 0;
    for (int t = 0; t < 500; ++t) {
        const auto sample = moving_sample<TestType>(t, engine);
        sliced.tick(sample, Budget{operations(engine)});
        for (bool idle = sliced.advance(Budget::predict_only()); !idle; ++slices) {
            idle = sliced.advance(Budget{operations(engine)});
        }
        whole.tick(sample, Budget::unlimited());
        different += weights_of(sliced) == weights_of(whole) ? 0 : 1;
    }
    CHECK(slices >= 400);
    CHECK(different == 0);
    CHECK(sliced.counters().learned == whole.counters().learned);
    CHECK(sliced.advance(Budget::predict_only()));
}

TEST_CASE("the cost of a tick is a constant expression of the model's sizes") {
    constexpr Cost cost = Estimator<UdFloat>::cost();
    STATIC_REQUIRE(cost.predict > 0 && cost.variance > 0 && cost.learn > cost.largest_step);
    // Inputs: n k (M+2); features: d n k and the cosines and sines; weights: m 2d; estimate: 14 + m (15 + a
    // square root).
    STATIC_REQUIRE(cost.predict == 2 * 3 * 8 + 15 * 6 + cos_sin_cost<float>(15) + 2 * 30 + 2 * 45 + 14);
}

} // namespace estimator_budget_test
