// SPDX-License-Identifier: Apache-2.0
// No call of the library touches the heap.
#include "dfdyn/dfdyn.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <limits>
#include <optional>

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

/// Ticks of every kind: filling, learned at once, in slices, blind, refused, after a gap and after a clock
/// restart.
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

/// Everything that can be asked of a learner.
template <class Model>
void use(const Estimator<Model>& estimator) {
    typename Model::Scalar means[Model::outputs];
    const auto& learner = estimator.regression().learner();
    learner.predict(estimator.regression().columns(), means);
    static_cast<void>(learner.variance(estimator.regression().columns()));
    static_cast<void>(learner.parameter_variance(1));
    static_cast<void>(learner.weights(0));
    static_cast<void>(learner.last_ratio());
    static_cast<void>(learner.idle() || learner.sample_pending());
    static_cast<void>(estimator.counters().ticks + name(Reason::gap)[0]);
}

/// Calls every function of an estimator; returns the heap calls on the way.
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

template <class Scalar, class Input, template <class, int, int> class Form>
void check(std::mt19937_64& engine) {
    using Model = TestModel<Scalar, Input, 4, Form>;
    const auto constants = make_constants<Model>(engine, 0.99);
    const HeapCalls calls = heap_calls<Model>(constants, samples_of_every_kind<Model>(engine));
    CHECK(calls.allocations == 0);
    CHECK(calls.releases == 0);
}

} // namespace

TEMPLATE_TEST_CASE("nothing in an estimator's life calls the heap", "", DerivativeFree<5>,
                   DerivativeFreeWeighted<5>, (DerivativeFreeReduced<5, 3>), DerivativeFreeStructured<5>,
                   DerivativeFreeStructuredRecursive<5>, Standard<5>, StandardMeasured) {
    DFDYN_SEEDED_ENGINE(engine);
    check<float, TestType, UdCovariance>(engine);
    check<double, TestType, UdCovariance>(engine);
    check<float, TestType, CholeskyInformation>(engine);
    check<double, TestType, CholeskyInformation>(engine);
}
