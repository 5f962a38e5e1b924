// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/backlog.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <random>

namespace backlog_test {

using dfdyn::hal::BacklogGate;

constexpr std::int64_t period_ns = 2'000'000;

TEST_CASE("the frames that waited during a pause are recognised, except the first, and no others") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_int_distribution<std::int64_t> periods(3, 50), jitter_ns(0, period_ns / 5);
    BacklogGate gate(period_ns);
    std::int64_t stamp_ns = 5'000'000'000;
    for (int pause = 0; pause < 200; ++pause) {
        for (int frame = 0; frame < 20; ++frame) {
            stamp_ns += period_ns;
            REQUIRE_FALSE(gate.waited(stamp_ns + jitter_ns(engine)));
        }
        const std::int64_t missed = periods(engine);
        stamp_ns += missed * period_ns + period_ns / 5;
        REQUIRE_FALSE(gate.waited(stamp_ns));
        for (std::int64_t frame = 1; frame < missed; ++frame) {
            REQUIRE(gate.waited(stamp_ns + frame * period_ns / 50 / 50));
        }
    }
}

TEST_CASE("after a pause no more frames count as waiting than periods have passed") {
    BacklogGate gate(period_ns);
    CHECK_FALSE(gate.waited(0));
    CHECK_FALSE(gate.waited(4 * period_ns));
    int waited = 0;
    for (int frame = 1; frame <= 100; ++frame) {
        waited += gate.waited(4 * period_ns + frame) ? 1 : 0;
    }
    CHECK(waited == 3);
}

TEST_CASE("frames of two senders without a pause do not count as waiting") {
    BacklogGate gate(period_ns);
    for (std::int64_t frame = 0; frame < 1000; ++frame) {
        CHECK_FALSE(gate.waited(frame * period_ns));
        CHECK_FALSE(gate.waited(frame * period_ns + period_ns / 5));
    }
}

TEST_CASE("a frame that is late by nearly a period does not make the next one wait") {
    BacklogGate gate(period_ns);
    for (std::int64_t frame = 0; frame < 1000; ++frame) {
        CHECK_FALSE(gate.waited(frame * period_ns + (frame % 3 == 1 ? 9 * period_ns / 10 : 0)));
    }
}

} // namespace backlog_test
