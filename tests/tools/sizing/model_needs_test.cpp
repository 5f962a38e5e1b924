// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/model_needs.hpp"

#include "dfdyn/dfdyn.hpp"
#include "tests/support/catch.hpp"

namespace model_needs_test {

namespace tools = dfdyn::tools;

/// A model whose numbers are arbitrary; only its sizes matter.
tools::TrainedModel sized_model(int joints, int outputs, int lags, int rows, int features) {
    tools::TrainedModel model;
    model.joints = joints;
    model.sample_period_s = 0.001;
    model.input.lags = lags;
    model.input.rows_per_joint = rows;
    model.input.rows.assign(static_cast<std::size_t>(rows * (lags + 1)), 1);
    model.input.scale.assign(static_cast<std::size_t>(rows * joints), 1);
    model.features.length_scale = 1;
    const auto count = static_cast<std::size_t>(outputs);
    for (std::size_t k = 1; k <= count; ++k) {
        model.outputs.names.push_back("tau" + std::to_string(k));
    }
    model.outputs.offset.assign(count, 0);
    model.outputs.noise_std.assign(count, 1);
    model.limits.position_rad.assign(static_cast<std::size_t>(joints), 7);
    model.limits.output.assign(count, 100);
    model.limits.innovation = 100;
    return tools::with_feature_count(model, features);
}

template <int n, int M, int k, int d>
void compare() {
    using Model =
        dfdyn::Model<float, dfdyn::Joints<n, n>, dfdyn::DerivativeFreeReduced<M, k>, dfdyn::RandomFourier<d>>;
    constexpr dfdyn::Footprint real = dfdyn::Estimator<Model>::footprint();
    constexpr dfdyn::Cost cost = dfdyn::Estimator<Model>::cost();
    const tools::ModelNeeds needs = tools::needs_of(sized_model(n, n, M, k, d));
    CAPTURE(n, M, k, d);
    CHECK(needs.ram_bytes >= real.state_bytes + real.stack_bytes);
    CHECK(needs.ram_bytes <= real.state_bytes + 6 * 1024);
    CHECK(needs.flash_bytes >= real.constant_bytes + 16 * 1024);
    CHECK(needs.flash_bytes <= real.constant_bytes + 24 * 1024);
    CHECK(needs.tick_operations == cost.predict + cost.learn);
}

TEST_CASE("the needs of a model are upper bounds for its firmware") {
    compare<6, 10, 3, 25>();
    compare<6, 10, 3, 100>();
    compare<6, 399, 3, 63>();
    compare<1, 4, 2, 10>();
    compare<7, 20, 4, 160>();
}

TEST_CASE("forgetting increases the number of operations") {
    tools::TrainedModel model = sized_model(2, 2, 4, 3, 20);
    const auto without = tools::needs_of(model).tick_operations;
    model.forgetting_factor = 0.999;
    CHECK(tools::needs_of(model).tick_operations > without);
}

TEST_CASE("a budget limits each of the three needs") {
    const tools::ModelNeeds needs{100, 200, 300};
    CHECK(tools::fits(needs, {}));
    CHECK(tools::fits(needs, {100, 200, 300}));
    CHECK_FALSE(tools::fits(needs, {99, 200, 300}));
    CHECK_FALSE(tools::fits(needs, {100, 199, 300}));
    CHECK_FALSE(tools::fits(needs, {100, 200, 299}));
}

} // namespace model_needs_test
