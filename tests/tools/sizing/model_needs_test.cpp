// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/model_needs.hpp"

#include "dfdyn/dfdyn.hpp"
#include "tests/support/catch.hpp"
#include "tests/tools/sizing/sized_model.hpp"
#include "tests/tools/support/small_model.hpp"

#include <random>
#include <string>

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

using Motion = dfdyn::DerivativeFreeReduced<4, 3>;
using Features = dfdyn::RandomFourier<3>;

/// The physics of small_physics_model() with joint torques.
using Physics = dfdyn::Physics<Motion, 9, dfdyn::ViscousFriction<2>, dfdyn::CoulombFriction<1>,
                               dfdyn::StribeckFriction<1>, dfdyn::TorqueRipple<1>, dfdyn::OutputOffset<1>>;

template <class Input, class InputFeatures, class Structure>
void compare_physics(const std::string& structure) {
    using Model = dfdyn::Model<float, dfdyn::Chain<2>, Input, InputFeatures, Structure>;
    constexpr dfdyn::Footprint real = dfdyn::Estimator<Model>::footprint();
    constexpr dfdyn::Cost cost = dfdyn::Estimator<Model>::cost();
    std::mt19937_64 engine(1);
    const tools::ModelNeeds needs =
        tools::needs_of(dfdyn::tests::small_physics_model(engine, structure, tools::InputKind::DFR, false));
    CAPTURE(structure);
    CHECK(needs.ram_bytes >= real.state_bytes + real.stack_bytes);
    CHECK(needs.ram_bytes <= real.state_bytes + 6 * 1024);
    CHECK(needs.flash_bytes >= real.constant_bytes + 36 * 1024);
    CHECK(needs.flash_bytes <= real.constant_bytes + 44 * 1024);
    CHECK(needs.tick_operations >= cost.predict + cost.learn + cost.forget);
    CHECK(needs.tick_operations <= 2 * (cost.predict + cost.learn + cost.forget));
}

TEST_CASE("the needs of a model with physics are upper bounds for its firmware") {
    compare_physics<dfdyn::NoInput, dfdyn::NoFeatures, dfdyn::Parametric<Physics>>("P");
    compare_physics<Motion, Features, dfdyn::SemiparametricMean<Physics>>("SP");
    compare_physics<Motion, Features, dfdyn::SemiparametricMean<Physics>>("SP2");
    compare_physics<Motion, Features, dfdyn::SemiparametricKernel<Physics>>("SPK");
}

TEST_CASE("a size that exceeds its budget is larger also as text") {
    tools::TargetBudget budget;
    budget.flash_bytes = 24 * 1024;
    CHECK(tools::to_text(budget) == "flash 24 KiB, RAM unlimited, unlimited multiply-adds per tick");
    CHECK(tools::to_text(tools::ModelNeeds{24 * 1024, 8 * 1024, 300}) ==
          "flash 24.0 KiB, RAM 8.0 KiB, 300 multiply-adds per tick");
    const tools::ModelNeeds larger{24 * 1024 + 1, 8 * 1024 + 41, 300};
    CHECK(tools::to_text(larger) == "flash 24.1 KiB, RAM 8.1 KiB, 300 multiply-adds per tick");
    CHECK(tools::excess_text(larger, budget) == "flash: expected at most 24 KiB, found 24.1 KiB");
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
