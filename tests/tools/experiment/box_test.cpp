// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/box.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/numerics/quantile.hpp"

#include <cmath>
#include <limits>

namespace tools = dfdyn::tools;

TEST_CASE("a box contains the quantiles of its values in any order") {
    // The values 0 to 100, whose quantile at a share is 100 times that share.
    std::vector<double> values;
    for (int i = 0; i <= 100; ++i) {
        values.push_back((37 * i) % 101);
    }
    const tools::Box box = tools::box_of(values);
    CHECK(box.count == 101);
    CHECK(box.low == Approx(5));
    CHECK(box.lower_quartile == Approx(25));
    CHECK(box.median == Approx(50));
    CHECK(box.upper_quartile == Approx(75));
    CHECK(box.high == Approx(95));
    CHECK(box.mean == Approx(50));
}

TEST_CASE("quantiles are interpolated between order statistics") {
    const std::vector<double> values{1, 2, 4, 8};
    CHECK(tools::quantile_of_sorted(values, 0) == 1);
    CHECK(tools::quantile_of_sorted(values, 0.25) == Approx(1.75));
    CHECK(tools::quantile_of_sorted(values, 0.5) == Approx(3));
    CHECK(tools::quantile_of_sorted(values, 0.75) == Approx(5));
    CHECK(tools::quantile_of_sorted(values, 1) == 8);
    CHECK(tools::median({5, 1, 3}) == 3);
    CHECK(tools::median({4, 1}) == Approx(2.5));
}

TEST_CASE("NaN is ignored and infinite values count") {
    const double infinite = std::numeric_limits<double>::infinity();
    const tools::Box box = tools::box_of({2, std::nan(""), 4});
    CHECK(box.count == 2);
    CHECK(box.median == 3);
    CHECK(box.mean == 3);
    const tools::Box lost = tools::box_of({infinite, 2, std::nan(""), infinite, 4, 1, 3});
    CHECK(lost.count == 6);
    CHECK(lost.lower_quartile == Approx(2.25));
    CHECK(lost.median == Approx(3.5));
    CHECK(lost.upper_quartile == infinite); // between 4 and infinity
    CHECK(lost.high == infinite);           // between two infinities
    CHECK(lost.mean == infinite);
    CHECK(tools::box_of({infinite}).median == infinite);
    CHECK(std::isnan(tools::median({})));
}
