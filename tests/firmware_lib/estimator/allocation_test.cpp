// SPDX-License-Identifier: Apache-2.0
// No call of the library uses the heap.
#include "dfdyn/dfdyn.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <limits>
#include <optional>

namespace estimator_allocation_test {

using namespace dfdyn;
using namespace dfdyn::tests;

/// Ticks of every kind: window filling, learned at once, learned in slices, without an output, rejected,
/// after a gap and after a clock restart.
template <class Model>
std::vector<typename Model::Sample> samples_of_every_kind(std::mt19937_64& engine) {
    std::vector<typename Model::Sample> samples;
    for (int t = 0; t < 60; ++t) {
        samples.push_back(moving_sample<Model>(t, engine));
    }
    samples[30].output_valid = false;
    samples[31].output[0] = std::numeric_limits<typename Model::Scalar>::quiet_NaN();
    samples[32].position[1] = std::numeric_limits<typename Model::Scalar>::infinity();
    samples[50].time_ns = 0;
    for (int t = 55; t < 60; ++t) {
        samples[static_cast<std::size_t>(t)].time_ns = t;
    }
    return samples;
}

/// Calls every function of a regression.
template <class Model>
void use(const Estimator<Model>& estimator) {
    typename Model::Scalar means[Model::outputs];
    typename Model::Scalar weights[Model::outputs * Model::columns + Model::parameters];
    const auto& regression = estimator.regression();
    regression.variances(means);
    regression.last_variance_ratios(means);
    regression.copy_weights(weights);
    regression.predict_with(weights, means);
    static_cast<void>(regression.idle() || regression.sample_pending());
    static_cast<void>(estimator.counters().ticks + name(Reason::gap)[0]);
    if constexpr (requires { regression.learner().last_variance_ratio(); }) {
        regression.learner().predict(regression.columns(), means);
        static_cast<void>(regression.learner().variance(regression.columns()));
        static_cast<void>(regression.learner().parameter_variance(1));
    }
}

/// Calls every function of an estimator; returns the number of heap calls.
template <class Model>
HeapCalls heap_calls(const typename Model::Constants& constants,
                     const std::vector<typename Model::Sample>& samples) {
    std::array<std::byte, Estimator<Model>::snapshot_capacity> buffer{};
    const AllocationGuard guard;
    Estimator<Model> estimator(constants);
    for (std::size_t t = 0; t < samples.size(); ++t) {
        estimator.tick(samples[t], Budget{t % 3 == 0 ? Estimator<Model>::cost().largest_step : 1'000'000});
        use(estimator);
    }
    bool right = estimator.snapshot(buffer) == SnapshotResult::ok;
    right = right && estimator.restore(buffer) == SnapshotResult::ok;
    buffer[40] ^= std::byte{1};
    right = right && estimator.restore(buffer) == SnapshotResult::corrupted;
    estimator.restart_window();
    estimator.reset();
    const HeapCalls calls = guard.calls();
    CHECK(right);
    return calls;
}

template <class Model>
void check(std::mt19937_64& engine) {
    const auto constants = make_constants<Model>(engine, 0.99);
    const HeapCalls calls = heap_calls<Model>(constants, samples_of_every_kind<Model>(engine));
    CHECK(calls.allocations == 0);
    CHECK(calls.releases == 0);
}

// Every input map, learner and structure, with either scalar. DFW and DFSR use the maps of DF and DFR.
TEMPLATE_TEST_CASE("no call of an estimator uses the heap", "", DerivativeFree<5>,
                   (DerivativeFreeReduced<5, 3>), DerivativeFreeStructured<5>, Standard<5>,
                   StandardMeasured) {
    DFDYN_SEEDED_ENGINE(engine);
    check<TestModel<float, TestType, 4>>(engine);
    check<TestModel<double, TestType, 4>>(engine);
}

TEMPLATE_TEST_CASE("no call of an estimator with physics uses the heap", "", (DerivativeFreeReduced<5, 3>),
                   DerivativeFreeStructured<5>, Standard<5>, StandardMeasured) {
    DFDYN_SEEDED_ENGINE(engine);
    check<TestParametric<double, TestType>>(engine);
    check<TestMean<double, TestType, 4>>(engine);
    check<TestKernel<float, TestType, 4>>(engine);
    check<TestKernel<float, DerivativeFree<5>, 4, TestType>>(
        engine); // different inputs for features and physics
}

} // namespace estimator_allocation_test
