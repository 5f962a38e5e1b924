// SPDX-License-Identifier: Apache-2.0
// Compares the cost functions with the operations performed, measured with a scalar that counts them.
#include "dfdyn/dfdyn.hpp"

#include "tests/firmware_lib/support/counted.hpp"
#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <limits>

namespace cost_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using Single = Counted<float>;
using Double = Counted<double>;

using UdSingle = TestModel<Single, DerivativeFreeReduced<6, 3>, 15>;
using UdDouble = TestModel<Double, DerivativeFreeReduced<6, 3>, 15>;
using UdWhole = TestModel<Double, DerivativeFreeReduced<6, 3>, 16>; // whole panels and vectors
using Parametric = TestParametric<Double>;
using Mean = TestMean<Double, DerivativeFree<6>, 15, DerivativeFreeReduced<6, 3>>;
using Kernel = TestKernel<Double, DerivativeFreeReduced<6, 3>, 15>;
using KernelSingle = TestKernel<Single, DerivativeFreeStructured<6>, 9, StandardMeasured>;

template <class Model>
constexpr Cost cost_of() {
    return Estimator<Model>::cost();
}

/// Counts the operations of one call.
template <class Call>
std::int64_t count(Call call) {
    counted_operations = 0;
    call();
    return counted_operations;
}

/// Returns a budget from none to more than a sample needs. Small budgets are frequent, because they stop near
/// the end of the work.
std::int64_t random_budget(const Cost& cost, std::mt19937_64& engine) {
    const std::int64_t most[] = {0, cost.largest_step, 2 * cost.largest_step, 2 * cost.learn};
    return std::uniform_int_distribution<std::int64_t>(0, most[engine() % 4])(engine);
}

/// Makes every sixth sample faulty, in one of the possible ways.
template <class Sample>
Sample perhaps_faulty(Sample sample, std::mt19937_64& engine) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    switch (engine() % 60) {
    case 0:
        sample.output_valid = false;
        break;
    case 1:
        sample.output[1] = nan;
        break;
    case 2:
        sample.position[0] = nan;
        break;
    case 3:
        sample.position[1] = 1e9;
        break;
    case 4:
        sample.output[0] = 1e9;
        break;
    case 5:
        sample.time_ns -= period_ns;
        break;
    case 6:
        sample.position[0] += 9; // a jump: feature arguments or motion out of range
        break;
    case 7:
    case 8:
    case 9:
        sample.output[0] += 20; // a contact
        break;
    default:
        break;
    }
    return sample;
}

TEMPLATE_TEST_CASE("a tick that learns its sample at once costs what prediction and learning cost together",
                   "", UdSingle, UdDouble, UdWhole, Parametric, Mean, Kernel, KernelSingle) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    constexpr Cost cost = cost_of<TestType>();
    int ticks = 0;
    for (int t = 0; t < 40; ++t) {
        const auto sample = moving_sample<TestType>(t, engine);
        bool learned = false;
        const std::int64_t operations =
            count([&] { learned = estimator.tick(sample, Budget::unlimited()).status.learned(); });
        if (learned) {
            ++ticks;
            CHECK(operations == cost.predict + cost.learn);
        }
    }
    CHECK(ticks >= 30);
}

// Beyond its budget a tick performs a prediction and a variance, for any sample; the maximum is reached
// exactly.
TEMPLATE_TEST_CASE("no tick performs more than a prediction and a variance and its budget", "", UdSingle,
                   UdDouble, UdWhole, Parametric, Mean, Kernel, KernelSingle) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Cost cost = cost_of<TestType>();
    for (const double forgetting_factor : {1.0, 0.99}) {
        auto constants = make_constants<TestType>(engine, forgetting_factor);
        constants.innovation_limit = 30;
        constants.innovation_patience = 30;
        Estimator<TestType> estimator(constants);
        std::int64_t most = 0;
        for (int t = 0; t < 12000; ++t) {
            const auto sample = perhaps_faulty(moving_sample<TestType>(t, engine), engine);
            const std::int64_t budget = random_budget(cost, engine);
            const std::int64_t operations = count([&] { estimator.tick(sample, Budget{budget}); });
            REQUIRE(operations <= cost.predict + cost.variance + std::max<std::int64_t>(budget, 0));
            most = std::max(most, budget <= 0 ? operations : 0);
        }
        CHECK(most <= cost.predict + cost.variance);
        CHECK(most == cost.predict + cost.variance);
    }
}

TEMPLATE_TEST_CASE("work between ticks stays within its budget and within the cost of learning", "", UdSingle,
                   UdDouble, UdWhole, Parametric, Mean, Kernel, KernelSingle) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Cost cost = cost_of<TestType>();
    for (const double forgetting_factor : {1.0, 0.99}) {
        const auto constants = make_constants<TestType>(engine, forgetting_factor);
        Estimator<TestType> estimator(constants);
        std::int64_t most = 0;
        for (int t = 0; t < 200; ++t) {
            estimator.tick(moving_sample<TestType>(t, engine), Budget{1}); // begins to learn the sample
            std::int64_t whole = 0;
            while (!estimator.regression().idle()) {
                const std::int64_t budget = random_budget(cost, engine);
                const std::int64_t operations = count([&] { estimator.advance(Budget{budget}); });
                REQUIRE(operations <= std::max<std::int64_t>(budget, 0));
                whole += operations;
            }
            REQUIRE(whole <= cost.learn + cost.forget);
            most = std::max(most, whole);
        }
        CHECK((forgetting_factor < 1 || most == cost.learn));
    }
}

// Columns, outputs and scalars in many proportions to panels and vectors.
TEMPLATE_TEST_CASE_SIG("the cost of learning is that of any size", "",
                       ((int columns, int outputs), columns, outputs), (1, 1), (2, 3), (4, 1), (5, 6), (8, 2),
                       (31, 1), (50, 6)) {
    const auto check = [](auto learner_type) {
        using Learner = typename decltype(learner_type)::type;
        const typename Learner::Constants constants{10, 1, nullptr};
        Learner learner(constants, {}, {});
        constexpr Cost cost = Learner::cost(columns, outputs);
        Double row[columns];
        Double target[outputs];
        Double means[outputs];
        std::fill_n(row, columns, 0.25);
        std::fill_n(target, outputs, 1);
        for (int t = 0; t < 3; ++t) {
            Budget budget = Budget::unlimited();
            CHECK(count([&] { learner.predict(row, means); }) == cost.predict);
            CHECK(count([&] { learner.begin(row, target); }) == 0);
            CHECK(count([&] { learner.advance(budget); }) == cost.learn);
            CHECK(Budget::unlimited().operations - budget.operations == cost.learn);
        }
    };
    check(std::type_identity<UdCovariance<Double, columns, outputs>>{});
}

TEMPLATE_TEST_CASE("an input map costs what its declaration says", "", DerivativeFree<6>,
                   DerivativeFreeWeighted<3>, (DerivativeFreeReduced<6, 3>), DerivativeFreeStructured<6>,
                   StandardMeasured, Standard<2>, Standard<6>, Standard<20>) {
    constexpr int joints = 5;
    using Map = typename TestType::template Map<Double, joints>;
    const typename Map::Constants constants{};
    Map map(constants, {}, {}, {});
    typename TestType::template Sample<Double, joints, 1>
        sample{}; // standstill: all windows have full length
    Double xi[joints * TestType::features_per_joint];
    for (int t = 0; t < 2 * TestType::lags + 2; ++t) {
        sample.time_ns += 1'000'000;
        counted_operations = 0;
        map.push(sample);
    }
    map.evaluate(xi);
    CHECK(counted_operations == Map::cost(joints, TestType::lags, TestType::features_per_joint));
}

TEMPLATE_TEST_CASE_SIG("the feature map costs what its declaration says", "", ((int d), d), 1, 4, 7, 16, 25,
                       250) {
    const auto check = [](auto number) {
        using Number = decltype(number);
        const typename RandomFourier<d>::template Constants<Number, 12> constants{};
        const Number xi[12] = {};
        Number phi[2 * d];
        CHECK(count([&] { RandomFourier<d>::template evaluate<Number, 12>(constants, {}, {}, xi, phi); }) ==
              RandomFourier<d>::template cost<Number>(12, d));
    };
    check(Single{});
    check(Double{});
}

// Every inertial parameter and every effect is selected; at zero velocity the Stribeck term is computed
// completely.
TEST_CASE("the physics map costs what its declaration says") {
    using Arm = Chain<3>;
    constexpr int columns = 10 * 3 + 6 * 3;
    using Columns = Physics<StandardMeasured, columns, ViscousFriction<3>, CoulombFriction<3>,
                            StribeckFriction<3>, RotorInertia<3>, TorqueRipple<3>, OutputOffset<3>>;
    using Map = Columns::Map<Double, Arm>;
    Map::Constants constants{};
    Storage<std::int32_t, 3> rows{{0, 1, 2}};
    constants.effects = {{rows}, {rows, {{1, 1, 1}}}, {rows, {{1, 1, 1}}, {{1, 1, 1}}},
                         {rows}, {rows, {}, {}},      {rows}};
    for (int c = 0; c < columns; ++c) {
        constants.selected[c] = c;
    }
    Map map(constants, {});
    Double psi[3 * columns];
    const SampleWithDerivatives<Double, 3, 3> sample{};
    CHECK(count([&] {
              map.push(sample);
              CHECK(map.evaluate(psi));
          }) == Map::cost({}));
}

} // namespace cost_test
