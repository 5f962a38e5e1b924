// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/suites/timed_loop.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/text/error.hpp"
#include "tools/bench/suites/loop_bench.hpp"

#include <algorithm>

namespace {

using namespace dfdyn::tools;

} // namespace

TEST_CASE("a timed loop calls each tick once in order and reports its time") {
    std::vector<std::size_t> called;
    const TimedLoop timed =
        time_loop({.period_s = 0.001, .duration_s = 0.05}, [&](std::size_t tick) { called.push_back(tick); });
    REQUIRE(called.size() == 50);
    CHECK(std::ranges::is_sorted(called));
    CHECK(called.front() == 0);
    CHECK(called.back() == 49);
    CHECK(timed.pace.ticks == 50);
    REQUIRE(timed.late_us.size() == 50);
    REQUIRE(timed.duration_us.size() == 50);
    CHECK(*std::ranges::min_element(timed.late_us) >= 0); // no tick begins before it is due
    CHECK(*std::ranges::min_element(timed.duration_us) >= 0);
    CHECK(timed.cores > 0);
    CHECK(static_cast<double>(timed.pace.longest_ns) ==
          Approx(1000 * *std::ranges::max_element(timed.duration_us)));
}

TEST_CASE("a timed loop rejects a period and duration without ticks or with too many") {
    const auto nothing = [](std::size_t) {};
    CHECK_THROWS_AS(time_loop({.period_s = 0, .duration_s = 1}, nothing), InputError);
    CHECK_THROWS_AS(time_loop({.period_s = 2, .duration_s = 1}, nothing), InputError);
    CHECK_THROWS_AS(time_loop({.period_s = 0.001, .duration_s = 4000}, nothing), InputError);
}

TEST_CASE(
    "a loop with a background load learns every sample after the first window and its quantiles increase") {
    const LoopBench bench = run_loop_bench(0.2);
    CHECK(bench.pace.ticks == 200);
    CHECK(bench.learned == 190); // after the first ten lags
    for (const TickTimes& times : {bench.late, bench.duration}) {
        CHECK(times.median >= 0);
        CHECK(times.p99 >= times.median);
        CHECK(times.p999 >= times.p99);
        CHECK(times.p9999 >= times.p999);
        CHECK(times.most >= times.p9999);
    }
    CHECK(bench.duration.median > 0);
}
