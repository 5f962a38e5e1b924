// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/learner/forgetting.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace forgetting_test {

using dfdyn::Forgetting;

/// Information (nats) that may be forgotten per nat of a sample, as documented, for 40 parameters or more.
constexpr double payback = 20;

/// Returns the nats per parameter that were discarded over `samples` samples without information.
template <class Scalar>
double forgotten_at_rest(Forgetting<Scalar>& forgetting, int samples) {
    double nats = 0;
    for (int t = 0; t < samples; ++t) {
        nats -= std::log(static_cast<double>(forgetting.factor_after(1)));
    }
    return nats;
}

TEMPLATE_TEST_CASE("a factor of one never forgets", "", float, double) {
    Forgetting<TestType> forgetting(1, 10);
    CHECK_FALSE(forgetting.active());
    CHECK(forgetting.factor_after(100) == 1);
    CHECK(forgetting.factor_after(1) == 1);
}

TEMPLATE_TEST_CASE("the factor is applied exactly while samples contribute enough", "", float, double) {
    const auto factor = TestType(0.999);
    constexpr int parameters = 100;
    const double price = -parameters * std::log(static_cast<double>(factor));
    const auto ratio = static_cast<TestType>(std::exp(1.001 * price / payback));
    Forgetting<TestType> forgetting(factor, parameters);
    int exact = 0;
    for (int t = 0; t < 100'000; ++t) {
        exact += forgetting.factor_after(ratio) == factor ? 1 : 0;
    }
    CHECK(forgetting.active());
    CHECK(exact == 100'000);
}

TEMPLATE_TEST_CASE("a standstill forgets one horizon and then nothing", "", float, double) {
    for (const int parameters : {1, 7, 1000}) {
        for (const double horizon : {1.0, 3.0, 10.0}) { // in samples per parameter
            const double factor = parameters == 1 ? 0.9 : 1 - 1 / (horizon * parameters);
            CAPTURE(factor, parameters);
            Forgetting<TestType> forgetting(static_cast<TestType>(factor), parameters);
            const double tolerance = 1e4 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
            CHECK(forgotten_at_rest(forgetting, 30'000) == Approx(1).epsilon(tolerance));
            CHECK(forgetting.factor_after(1) == 1);
        }
    }
}

TEMPLATE_TEST_CASE("the information account is limited to one horizon and restart fills it", "", float,
                   double) {
    Forgetting<TestType> forgetting(TestType(0.99), 5);
    for (int t = 0; t < 1000; ++t) {
        static_cast<void>(forgetting.factor_after(1000));
    }
    const double tolerance = 1e4 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
    // The last sample has used its part.
    CHECK(forgotten_at_rest(forgetting, 10'000) == Approx(1 + std::log(0.99)).epsilon(tolerance));
    CHECK(forgotten_at_rest(forgetting, 10'000) == 0);
    forgetting.restart();
    CHECK(forgotten_at_rest(forgetting, 10'000) == Approx(1).epsilon(tolerance));
}

TEST_CASE("forgetting is limited by the information account and uses all of it") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int parameters = 40;
    constexpr double factor = 0.99;
    const double price = -parameters * std::log(factor);
    std::exponential_distribution<double> brought(1 / (0.9 * price / payback));
    Forgetting<double> forgetting(factor, parameters);
    double account = parameters;
    int paid_in_full = 0;
    for (int t = 0; t < 10'000; ++t) {
        const double nats = brought(engine);
        const double paid = std::expm1(nats) < 1 - factor ? 0 : payback * nats;
        account = std::min<double>(account + paid, parameters);
        const double applied = forgetting.factor_after(std::exp(nats));
        REQUIRE(applied == Approx(account >= price ? factor : std::exp(-account / parameters)).epsilon(1e-9));
        paid_in_full += account >= price ? 1 : 0;
        account = std::max(account - price, 0.0);
    }
    CHECK(paid_in_full > 1000); // both branches were taken
    CHECK(paid_in_full < 9000);
}

// The rows of a sample always excite the same directions of p parameters; v is their variance. The
// information discarded about all p is then bounded by that learned in these directions, about log(ticks (1 -
// factor)) each.
TEMPLATE_TEST_CASE("a standstill stops forgetting for any number of rows per sample", "", float, double) {
    const struct { int parameters, rows; } cases[] = {{10, 2}, {23, 6}, {60, 6}, {16, 1}, {64, 1}};
    for (const auto& one : cases) {
        CAPTURE(one.parameters, one.rows);
        const double factor = 0.999;
        Forgetting<TestType> forgetting(static_cast<TestType>(factor), one.parameters, one.rows);
        double variance = 1 - factor;
        double nats = 0;
        for (int t = 0; t < 100'000; ++t) {
            const auto ratio = static_cast<TestType>(std::pow(1 + variance, one.rows));
            const auto applied = static_cast<double>(forgetting.factor_after(ratio));
            nats -= std::log(applied);
            variance = variance / (1 + variance) / applied;
        }
        CHECK(nats < 8); // of 100 with the full factor
    }
}

TEMPLATE_TEST_CASE("rows with no more information than at standstill do not allow forgetting", "", float,
                   double) {
    const auto paid = [](int rows, double brought) {
        Forgetting<TestType> forgetting(TestType(0.999), 32, rows);
        static_cast<void>(forgotten_at_rest(forgetting, 30'000)); // the account is empty
        return forgetting.factor_after(static_cast<TestType>(1 + rows * brought)) < 1;
    };
    for (const int rows : {1, 6}) {
        CAPTURE(rows);
        CHECK_FALSE(paid(rows, 0.00095));
        CHECK(paid(rows, 0.00105));
    }
}

TEST_CASE("a moving arm with fewer parameters than rows forgets with the full factor") {
    for (const int parameters : {2, 4, 8}) {
        CAPTURE(parameters);
        constexpr double factor = 0.99;
        Forgetting<double> forgetting(factor, parameters, 6);
        const double brought = std::pow(factor, -parameters); // contribution of a steady motion
        for (int t = 0; t < 1000; ++t) {
            REQUIRE(forgetting.factor_after(brought) == factor);
        }
    }
}

TEST_CASE("rows with only rounding errors do not allow forgetting for any memory") {
    constexpr float epsilon = std::numeric_limits<float>::epsilon();
    const auto paid = [](float brought) {
        Forgetting<float> forgetting(0.99999F, 32);
        static_cast<void>(forgotten_at_rest(forgetting, 3'000'000)); // the account is empty
        return forgetting.factor_after(1 + brought) < 1;
    };
    CHECK_FALSE(paid(1000 * epsilon));
    CHECK(paid(4000 * epsilon));
}

TEST_CASE("an arm rests if the account is empty and the last sample paid nothing") {
    Forgetting<double> forgetting(0.99, 10);
    constexpr double no_information = 1;
    constexpr double information = 1.1;
    CHECK_FALSE(forgetting.resting());
    static_cast<void>(forgetting.factor_after(no_information));
    CHECK_FALSE(forgetting.resting()); // the account is still full
    static_cast<void>(forgotten_at_rest(forgetting, 1000));
    CHECK(forgetting.resting());
    static_cast<void>(forgetting.factor_after(information));
    CHECK_FALSE(forgetting.resting());
    static_cast<void>(forgotten_at_rest(forgetting, 1000));
    CHECK(forgetting.resting());
    forgetting.restart();
    CHECK_FALSE(forgetting.resting());
}

TEST_CASE("the parameters are checked in cyclic order") {
    Forgetting<float> forgetting(0.99F, 3);
    for (const int parameter : {0, 1, 2, 0, 1}) {
        CHECK(forgetting.next_parameter() == parameter);
    }
    forgetting.restart();
    CHECK(forgetting.next_parameter() == 0);
}

} // namespace forgetting_test
