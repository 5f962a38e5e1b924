// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/frozen_effort.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace frozen_effort_test {

using dfdyn::hal::FrozenEffortGate;

double position(int tick) { return 2e-3 * tick; }
double effort(int tick) { return std::round(500 * std::sin(0.01 * tick)) / 100; }

TEST_CASE("an effort that repeats its value in motion is frozen until it changes") {
    FrozenEffortGate gate(100);
    for (int tick = 0; tick < 2000; ++tick) {
        CHECK_FALSE(gate.frozen(effort(tick), position(tick)));
    }
    int accepted = 0;
    for (int tick = 2000; tick < 2500; ++tick) {
        accepted += gate.frozen(effort(2000), position(tick)) ? 0 : 1;
    }
    CHECK(accepted < 100);
    CHECK(gate.count() == 1);
    CHECK_FALSE(gate.frozen(effort(2500), position(2500)));
}

TEST_CASE("a constant effort of a joint at rest is accepted") {
    FrozenEffortGate gate(100);
    for (int tick = 0; tick < 5000; ++tick) {
        CHECK_FALSE(gate.frozen(3, 0.5));
    }
}

TEST_CASE("the configured limit applies until the device's resolution is learned") {
    FrozenEffortGate gate(100);
    for (int tick = 0; tick < 150; ++tick) {
        CHECK(gate.frozen(3, position(tick)) == (tick >= 99));
    }
}

TEST_CASE("the device's resolution is also learned at rest, if the effort changes") {
    FrozenEffortGate gate(100);
    for (int tick = 0; tick < 200; ++tick) {
        CHECK_FALSE(gate.frozen(0.01 * (tick % 3), 0.5));
    }
    int accepted = 0;
    for (int tick = 0; tick < 90; ++tick) {
        accepted += gate.frozen(3, position(tick)) ? 0 : 1;
    }
    CHECK(accepted < 20);
}

TEST_CASE("a device that holds its values in motion only is rejected temporarily") {
    FrozenEffortGate gate(100);
    for (int tick = 0; tick < 200; ++tick) {
        CHECK_FALSE(gate.frozen(0.01 * (tick % 3), 0.5));
    }
    int late = 0;
    for (int tick = 0; tick < 2000; ++tick) {
        const bool frozen = gate.frozen(0.5 * (tick / 10 % 7), position(tick));
        late += frozen && tick >= 400 ? 1 : 0;
    }
    CHECK(late == 0);
    for (int tick = 0; tick < 90; ++tick) { // a frozen one is still detected early
        late += gate.frozen(9, position(2000 + tick)) ? 1 : 0;
    }
    CHECK(late > 50);
}

TEST_CASE("lost values do not delay the detection of a frozen effort") {
    constexpr std::int64_t period = 2'000'000;
    const auto found_at = [](int kept_of_three) {
        FrozenEffortGate gate(100, period);
        for (int tick = 0; tick < 2000; ++tick) {
            gate.frozen(effort(tick), position(tick), tick * period);
        }
        int tick = 2000;
        while (tick % 3 >= kept_of_three || !gate.frozen(9, position(tick), tick * period)) {
            ++tick;
        }
        return tick;
    };
    CHECK(found_at(3) < 2100);
    CHECK(found_at(2) <= found_at(3) + 2); // at the next value that arrives
    CHECK(found_at(1) <= found_at(3) + 3);
}

TEST_CASE("an equal effort after a silence is not frozen") {
    constexpr std::int64_t period = 2'000'000;
    FrozenEffortGate gate(100, period);
    for (int tick = 0; tick < 2000; ++tick) {
        gate.frozen(effort(tick), position(tick), tick * period);
    }
    gate.frozen(9, position(2000), 2000 * period);
    CHECK_FALSE(gate.frozen(9, position(4000), 4000 * period));
}

} // namespace frozen_effort_test
