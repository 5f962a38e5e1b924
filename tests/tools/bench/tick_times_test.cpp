// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/timing/tick_times.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace dfdyn::tools;

TEST_CASE("the statistics of ticks are those of their sorted times") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<double> times(1001);
    std::iota(times.begin(), times.end(), 1.0);
    std::ranges::shuffle(times, engine);
    const TickTimes result = summarise(times, 0.75);
    CHECK(result.ticks == 1001);
    CHECK(result.median == 501);
    CHECK(result.p90 == Approx(901));
    CHECK(result.p99 == Approx(991));
    CHECK(result.p999 == Approx(1000));
    CHECK(result.most == 1001);
    CHECK(result.spread == Approx(500.0 / 501));
    CHECK(result.accepted == 0.75);
}

TEST_CASE("without ticks all statistics are zero") {
    const TickTimes result = summarise({}, 0);
    CHECK(result.ticks == 0);
    CHECK(result.median == 0);
    CHECK(result.most == 0);
}

TEST_CASE("the exponent of a power law is found for any factor") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int turn = 0; turn < 20; ++turn) {
        const double exponent = std::uniform_real_distribution<double>(0, 3)(engine);
        const double factor = std::uniform_real_distribution<double>(0.1, 10)(engine);
        const std::vector<double> sizes{200, 500, 1000, 2000};
        std::vector<double> times;
        for (const double size : sizes) {
            times.push_back(factor * std::pow(size, exponent));
        }
        CHECK(fitted_exponent(sizes, times) == Approx(exponent).margin(1e-12));
    }
}

TEST_CASE("an exponent is fitted to all points") {
    // y = 0, 1, 3 at x = 0, 1, 2 (natural logarithms): slope 1.5
    CHECK(fitted_exponent(std::vector<double>{1, std::exp(1), std::exp(2)},
                          std::vector<double>{1, std::exp(1), std::exp(3)}) == Approx(1.5));
}
