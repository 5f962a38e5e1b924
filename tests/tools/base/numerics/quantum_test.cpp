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

} // namespace
