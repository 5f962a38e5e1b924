// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/model.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <cmath>

namespace model_test {

using namespace dfdyn;
using namespace dfdyn::tests;

/// A model at least as large as in the paper, stored completely in .bss as on a microcontroller.
using LargeModel = TestModel<float, DerivativeFreeReduced<10, 3>, 500>;
LargeModel::Constants large_constants;
Estimator<LargeModel> large_estimator{large_constants};

static_assert(LargeModel::columns == 1000);
constexpr std::size_t large_bytes = sizeof(Estimator<LargeModel>);
static_assert(large_bytes > 1000 * 1000 / 2 * sizeof(float));
static_assert(large_bytes < 1000 * 1000 / 2 * sizeof(float) + 50'000);
static_assert(Estimator<LargeModel>::cost().learn < 1000 * 1000 * 2);
static_assert(Estimator<LargeModel>::cost().predict < 100'000);
static_assert(Estimator<LargeModel>::snapshot_capacity < large_bytes);

using FixedModel = TestModel<float>;
using DynamicModel =
    Model<float, Joints<dynamic, dynamic>, DerivativeFreeReduced<dynamic, dynamic>, RandomFourier<dynamic>>;

template <int count>
Storage<float, dynamic> on_heap(const Storage<float, count>& values) {
    auto result = Storage<float, dynamic>::zeros({count});
    std::copy(values.begin(), values.end(), result.begin());
    return result;
}

DynamicModel::Constants on_heap(const FixedModel::Constants& fixed) {
    DynamicModel::Constants constants{};
    constants.sizes = {{FixedModel::joints},
                       {FixedModel::outputs},
                       {FixedModel::Input::lags},
                       {FixedModel::Input::features_per_joint},
                       {FixedModel::Features::count}};
    constants.identity = fixed.identity;
    constants.gap_ns = fixed.gap_ns;
    constants.period_ns = fixed.period_ns;
    constants.input.rows = on_heap(fixed.input.rows);
    constants.input.scale = on_heap(fixed.input.scale);
    constants.features.frequencies = on_heap(fixed.features.frequencies);
    constants.features.amplitude = fixed.features.amplitude;
    constants.output_offset = on_heap(fixed.output_offset);
    constants.output_noise_std = on_heap(fixed.output_noise_std);
    constants.position_limit = on_heap(fixed.position_limit);
    constants.output_limit = on_heap(fixed.output_limit);
    constants.innovation_limit = fixed.innovation_limit;
    constants.learner = {fixed.learner.prior_variance, fixed.learner.forgetting_factor, nullptr};
    return constants;
}

TEST_CASE("a model with 500 features and 1000 columns works in static storage") {
    DFDYN_SEEDED_ENGINE(engine);
    large_constants = make_constants<LargeModel>(engine);
    large_estimator.reset();
    for (int t = 0; t < 200; ++t) {
        const auto estimate = large_estimator.tick(moving_sample<LargeModel>(t, engine), Budget::unlimited());
        if (t >= 10) {
            REQUIRE(estimate.status.learned());
            REQUIRE(std::isfinite(estimate.prediction[0]));
        }
    }
    CHECK(large_estimator.snapshot_bytes() <= Estimator<LargeModel>::snapshot_capacity);
}

// The host's tools run models of any size with the same code, so that their results are those of the
// firmware.
TEST_CASE("a model with run-time sizes behaves like the firmware's model") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<FixedModel>(engine, 0.999);
    const auto host_constants = on_heap(constants);
    Estimator<FixedModel> firmware(constants);
    Estimator<DynamicModel> host(host_constants);
    CHECK(host.snapshot_bytes() == firmware.snapshot_bytes());
    CHECK(Estimator<DynamicModel>::cost(host_constants.sizes).learn == Estimator<FixedModel>::cost().learn);
    for (int t = 0; t < 500; ++t) {
        const auto sample = moving_sample<FixedModel>(t == 250 ? 240 : t, engine);
        const Estimator<DynamicModel>::Sample host_sample{sample.time_ns, on_heap(sample.position),
                                                          on_heap(sample.output), sample.output_valid};
        const auto expected = firmware.tick(sample, Budget{2000});
        const auto estimate = host.tick(host_sample, Budget{2000});
        REQUIRE(estimate.status.reason() == expected.status.reason());
        for (int k = 0; k < 2; ++k) {
            REQUIRE(estimate.prediction[k] == Approx(expected.prediction[k]).epsilon(1e-4).margin(1e-4));
            REQUIRE(estimate.standard_deviation[k] == Approx(expected.standard_deviation[k]).epsilon(1e-4));
        }
    }
    // It also accepts a snapshot of the firmware.
    CHECK(host.restore(snapshot_of(firmware)) == SnapshotResult::ok);
    CHECK((snapshot_of(host) == snapshot_of(firmware)));
}

} // namespace model_test
