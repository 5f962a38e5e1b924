// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/clock/clock.hpp"

#include "tests/support/catch.hpp"

#include <limits>

namespace clock_test {

using dfdyn::hal::ClockGate;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1000 * ms;
constexpr int adopt_after = 5;

ClockGate make_gate() {
    return ClockGate({.tolerance_ns = 2 * ms, .max_step_ns = 50 * ms, .adopt_after = adopt_after});
}

/// Returns a gate after ten frames of a steady bus, 1 ms apart from 100 s on; the time is then 100.010 s.
ClockGate running_gate() {
    ClockGate gate = make_gate();
    for (int i = 0; i <= 10; ++i) {
        gate.accept(100 * second + i * ms, 100 * second + i * ms);
    }
    return gate;
}

TEST_CASE("stamps of a steady clock are unchanged") {
    ClockGate gate = make_gate();
    for (std::int64_t i = 0; i < 100; ++i) {
        CHECK(gate.accept(i * ms, i * ms + 300) == i * ms);
    }
    CHECK(gate.refused() == 0);
    CHECK_FALSE(gate.doubtful());
}

TEST_CASE("frames that overtake each other, and frames read late, are accepted") {
    ClockGate gate = running_gate();
    CHECK(gate.accept(100 * second + 8 * ms, 100 * second + 10 * ms) == 100 * second + 8 * ms);
    CHECK(gate.accept(100 * second + 11 * ms, 101 * second) == 100 * second + 11 * ms); // a late reader
    CHECK(gate.accept(100 * second + 990 * ms, 101 * second) == 100 * second + 990 * ms);
}

TEST_CASE("a stamp slightly ahead of the reader's time is limited to that time") {
    ClockGate gate = running_gate();
    CHECK(gate.accept(100 * second + 12 * ms, 100 * second + 11 * ms) == 100 * second + 11 * ms);
}

TEST_CASE("a single wrong stamp is rejected and has no further effect") {
    ClockGate gate = running_gate();
    CHECK_FALSE(gate.accept(94 * second, 100 * second + 11 * ms).has_value());
    CHECK(gate.doubtful());
    CHECK(gate.accept(100 * second + 12 * ms, 100 * second + 12 * ms).has_value());
    CHECK_FALSE(gate.doubtful());
    CHECK_FALSE(gate.accept(106 * second, 100 * second + 13 * ms).has_value());
    CHECK(gate.refused() == 2);
    CHECK(gate.adopted() == 0);
}

TEST_CASE("a new clock is adopted after several consistent frames, and the stamps continue") {
    for (const std::int64_t jump : {-6 * second, 6 * second, -50 * ms}) {
        ClockGate gate = running_gate();
        for (int i = 1; i <= 30; ++i) {
            const std::int64_t now = 100 * second + (10 + i) * ms;
            const auto stamp = gate.accept(now + jump, now);
            CHECK(stamp.has_value() == (i >= adopt_after));
            CHECK(stamp.value_or(now) == now);
        }
        CHECK(gate.adopted() == 1);
        CHECK(gate.refused() == adopt_after);
    }
}

TEST_CASE("inconsistent stamps are never adopted") {
    ClockGate gate = running_gate();
    for (std::int64_t i = 0; i < 1000; ++i) {
        const std::int64_t wild = i % 2 == 0 ? 1 * second : 2 * second;
        CHECK_FALSE(gate.accept(wild, 100 * second + 11 * ms).has_value());
    }
    for (std::int64_t i = 0; i < 1000; ++i) { // forward, in steps that are too long
        CHECK_FALSE(gate.accept(i * 51 * ms, 100 * second + 11 * ms).has_value());
    }
    CHECK(gate.adopted() == 0);
}

TEST_CASE("a first stamp far from the reader's time is rejected at first") {
    for (const std::int64_t start : {std::int64_t{0}, 200 * second, std::numeric_limits<std::int64_t>::min(),
                                     std::numeric_limits<std::int64_t>::max() - 50 * ms}) {
        ClockGate gate = make_gate();
        for (int i = 1; i < 20; ++i) {
            const std::int64_t now = 100 * second + i * ms;
            const auto stamp = gate.accept(start + i * ms, now);
            CHECK(stamp.has_value() == (i >= adopt_after));
            CHECK(stamp.value_or(now) == now);
        }
    }
}

} // namespace clock_test
