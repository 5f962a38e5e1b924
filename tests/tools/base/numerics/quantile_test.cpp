// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/quantile.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace tools = dfdyn::tools;

TEST_CASE("quantiles of a few values are the values themselves or interpolated between them") {
    const std::vector<double> values{9, 1, 5, 3};
    CHECK(tools::quantile(values, 0) == 1);
    CHECK(tools::quantile(values, 1) == 9);
    CHECK(tools::median(values) == 4);
    CHECK(tools::quantile(values, 0.25) == Approx(2.5));
    CHECK(tools::quantile(values, 0.9) == Approx(7.8));
    CHECK(tools::median({7}) == 7);
    CHECK(tools::median({2, 3, 1}) == 2);
    CHECK(std::isnan(tools::median({})));
}

TEST_CASE("the mean of squared normal values exceeds its quantiles with the stated probability") {
    const auto half = GENERATE(1, 2, 3, 6, 20); // of an even number of squares: a sum of exponential values
    CAPTURE(half);
    for (const auto& [normal_quantile, share] : {std::pair(-1.2816, 0.1), {0.0, 0.5}, {3.0902, 0.999}}) {
        CAPTURE(share);
        const double sum =
            half * tools::mean_square_quantile(2 * static_cast<std::size_t>(half), normal_quantile);
        double term = std::exp(-sum);
        double above = 0;
        for (int k = 0; k < half; ++k) {
            above += term;
            term *= sum / (k + 1);
        }
        CHECK(std::abs(above - (1 - share)) < 0.15 * std::min(share, 1 - share));
    }
}

TEST_CASE("quantiles are independent of order and increase with the share and mirror with the sign") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto count = GENERATE(range(std::size_t{1}, std::size_t{12}));
    CAPTURE(count);
    std::vector<double> values(count);
    std::ranges::generate(values, [&] { return std::round(dfdyn::tests::uniform(engine, -5, 5)); }); // ties
    std::vector<double> sorted = values;
    std::ranges::sort(sorted);
    std::vector<double> negated = values;
    std::ranges::transform(values, negated.begin(), [](double value) { return -value; });
    double last = sorted.front();
    for (double share = 0; share <= 1; share += 0.0625) {
        CAPTURE(share);
        const double here = tools::quantile(values, share);
        CHECK(here == tools::quantile_of_sorted(sorted, share));
        CHECK(here >= last);
        CHECK(tools::quantile(negated, 1 - share) == Approx(-here).margin(1e-12));
        last = here;
    }
    CHECK(last == sorted.back());
}
