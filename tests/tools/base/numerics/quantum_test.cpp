// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/quantum.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <random>
#include <vector>

namespace {

using dfdyn::tools::quantum_of;

TEST_CASE("the step of rounded values is found and values without one have none") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-3, 3);
    for (const double step : {1e-4, 1.5e-3, 0.25}) {
        std::vector<double> rounded;
        std::vector<double> free;
        for (int i = 0; i < 3000; ++i) {
            const double value = uniform(engine);
            rounded.push_back(step * std::round(value / step));
            free.push_back(value);
        }
        REQUIRE(quantum_of(rounded).has_value());
        CHECK(quantum_of(rounded).value() == Approx(step));
        CHECK_FALSE(quantum_of(free).has_value());
    }
}

TEST_CASE("too few different values have no step") {
    CHECK_FALSE(quantum_of({}).has_value());
    CHECK_FALSE(quantum_of({1, 1, 1, 1, 1, 1, 1}).has_value());
    CHECK_FALSE(quantum_of({0, 1, 2, 3, 4}).has_value());
    CHECK(quantum_of({0, 1, 2, 3, 4, 6}).value() == 1);
}

TEST_CASE("a motion of constant speed has no step, with or without a rest") {
    std::vector<double> turning;
    for (int i = 0; i < 400; ++i) {
        turning.push_back(0.314 * i + 0.002 * std::sin(0.01 * i));
    }
    CHECK_FALSE(quantum_of(turning).has_value());
    turning.insert(turning.end(), 500, turning.back());
    CHECK_FALSE(quantum_of(turning).has_value());
    std::vector<double> triangle;
    for (int i = 0; i < 400; ++i) {
        triangle.push_back(0.25 * std::abs(i % 40 - 20));
    }
    CHECK_FALSE(quantum_of(triangle).has_value());
}

TEST_CASE("a quantised signal has its step also at a constant speed") {
    for (const double speed : {0.01, 0.3, 0.9, 1.1}) {
        CAPTURE(speed);
        std::vector<double> values;
        for (int i = 0; i < 2000; ++i) {
            values.push_back(0.01 * std::round(speed * i));
        }
        REQUIRE(quantum_of(values).has_value());
        CHECK(quantum_of(values).value() == Approx(0.01));
    }
}

} // namespace
