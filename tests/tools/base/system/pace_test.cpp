// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/pace.hpp"

#include "tests/support/catch.hpp"

namespace pace_test {

using dfdyn::tools::Pace;

constexpr std::int64_t start = 1'000'000, period = 1000;

TEST_CASE("ticks are due at absolute times however late they begin and however long they take") {
    Pace pace(start, period);
    CHECK(pace.due_ns() == start + period);
    pace.begin(start + period + 700);
    pace.end(start + period + 900);
    CHECK(pace.due_ns() == start + 2 * period);
    pace.begin(start + 2 * period);
    pace.end(start + 9 * period);
    CHECK(pace.due_ns() == start + 3 * period);
}

TEST_CASE("a tick that begins after the next was due misses its deadline and each is counted") {
    Pace pace(start, period);
    CHECK_FALSE(pace.begin(pace.due_ns() + period));
    pace.end(pace.due_ns() + period);
    CHECK(pace.begin(pace.due_ns() + period + 1));
    pace.end(pace.due_ns() + period + 300);
    // After a stall of five periods the late ticks run at once until the time is caught up.
    const std::int64_t now = pace.due_ns() + 5 * period;
    int ticks = 0;
    for (; pace.due_ns() <= now; ++ticks) {
        pace.begin(now);
        pace.end(now);
    }
    CHECK(ticks == 6);
    CHECK(pace.counters().missed == 1 + 4);
    CHECK(pace.counters().ticks == 2 + 6);
    CHECK(pace.counters().worst_late_ns == 5 * period);
    CHECK(pace.counters().longest_ns == 299);
}

} // namespace pace_test
