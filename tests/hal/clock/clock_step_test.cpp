// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/clock/clock_step.hpp"
#include "tests/support/catch.hpp"

namespace clock_step_test {

using Watch = dfdyn::hal::ClockStepWatch<3>;

constexpr std::int64_t us = 1000;
constexpr std::int64_t period = 2000 * us;

/// Three sources, 100 µs apart. From tick 10 on, the clock of the sources in `set` is off by `set_ns`.
Watch after_step(std::int64_t set_ns, std::array<bool, 3> set, std::array<int, 3> lost = {}) {
    Watch watch;
    for (int tick = 0; tick < 20; ++tick) {
        for (int i = 0; i < 3; ++i) {
            const auto source = static_cast<std::size_t>(i);
            if (tick >= 10 && tick < 10 + lost[source]) {
                continue;
            }
            const std::int64_t by_ns = set[source] && tick >= 10 ? set_ns : 0;
            watch.take(i, tick * period + i * 100 * us + by_ns, period, 100 * us);
        }
    }
    return watch;
}

TEST_CASE("a clock step changes the intervals of all sources") {
    for (const std::int64_t by_us : {-3900, -1500, 1500, 3000}) {
        CAPTURE(by_us);
        const Watch watch = after_step(by_us * us, {true, true, true});
        REQUIRE(watch.step_ns(20 * period, 200 * us));
        CHECK(*watch.step_ns(20 * period, 200 * us) == by_us * us);
        CHECK_FALSE(watch.step_ns(200 * period, 200 * us)); // long ago
    }
}

TEST_CASE("a source that lost frames during a clock step still shows the step") {
    const Watch watch = after_step(-1500 * us, {true, true, true}, {0, 1, 2});
    REQUIRE(watch.step_ns(20 * period, 200 * us));
    CHECK(*watch.step_ns(20 * period, 200 * us) == -1500 * us);
}

TEST_CASE("frames that are repeated with their stamps do not hide a clock step") {
    Watch watch = after_step(1500 * us, {true, true, true});
    for (int source = 0; source < 3; ++source) {
        watch.take(source, 19 * period + source * 100 * us + 1500 * us, period, 100 * us);
    }
    REQUIRE(watch.step_ns(20 * period, 200 * us));
    CHECK(*watch.step_ns(20 * period, 200 * us) == 1500 * us);
}

TEST_CASE("a single late or early source is no clock step") {
    CHECK_FALSE(after_step(1500 * us, {true, false, false}).step_ns(20 * period, 200 * us));
    CHECK_FALSE(after_step(1500 * us, {true, true, false}).step_ns(20 * period, 200 * us));
    CHECK_FALSE(after_step(0, {true, true, true}).step_ns(20 * period, 200 * us));
    CHECK_FALSE(Watch().step_ns(0, 200 * us));
}

} // namespace clock_step_test
