// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/derivative_free.hpp"

#include "tests/firmware_lib/support/positions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <type_traits>

namespace derivative_free_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int joints = 3;
constexpr int lags = 6;

using Input = DerivativeFree<lags>;
using Constants = Input::Constants<double, joints>;
using Map = Input::Map<double, joints>;

Constants random_constants(std::mt19937_64& engine) {
    std::uniform_real_distribution<double> value(0.1, 10);
    Constants constants{};
    for (double& scale : constants.scale) {
        scale = value(engine);
    }
    return constants;
}

TEST_CASE("DF gives scaled positions, by joints and then by lags") {
    DFDYN_SEEDED_ENGINE(engine);
    const Constants constants = random_constants(engine);
    Map map(constants, {}, {}, {});
    for (int length = lags + 1; length < 40; ++length) {
        const Positions positions = random_positions(engine, length, joints);
        const auto xi = inputs_after<Map, double, joints>(map, positions, joints * (lags + 1));
        for (std::size_t i = 0; i < joints; ++i) {
            for (std::size_t lag = 0; lag <= lags; ++lag) {
                const std::size_t element = i * (lags + 1) + lag;
                CHECK(xi[element] ==
                      constants.scale[static_cast<int>(element)] * positions[positions.size() - 1 - lag][i]);
            }
        }
    }
}

TEST_CASE("DF is ready after M+1 samples") {
    const Constants constants{};
    Map map(constants, {}, {}, {});
    CHECK(ready_after<double, joints>(map, lags + 1));
}

TEST_CASE("DFW equals DF with the weights as part of the scale") {
    STATIC_REQUIRE(std::is_base_of_v<Input, DerivativeFreeWeighted<lags>>);
    STATIC_REQUIRE(DerivativeFreeWeighted<lags>::features_per_joint == lags + 1);
    STATIC_REQUIRE(Map::cost(joints, lags, lags + 1) == joints * (lags + 1));
}

} // namespace derivative_free_test
