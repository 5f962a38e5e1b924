// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/model_needs.hpp"

#include "dfdyn/dfdyn.hpp"
#include "tests/support/catch.hpp"
#include "tests/tools/sizing/sized_model.hpp"

namespace model_needs_test {

namespace tools = dfdyn::tools;
using dfdyn::tests::sized_model;

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
