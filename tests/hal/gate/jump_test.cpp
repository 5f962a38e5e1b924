// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/jump.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <random>

namespace jump_test {

using dfdyn::hal::JumpGate;

constexpr std::int64_t ms = 1'000'000;

double force(int tick) { return 20 * std::sin(0.02 * tick) + 0.05 * std::sin(7.0 * tick); }

JumpGate<1> ready_gate(int ticks) {
    JumpGate<1> gate(6 * ms);
    for (int tick = 0; tick < ticks; ++tick) {
        CHECK_FALSE(gate.jumps({force(tick)}, 2 * ms * tick));
    }
    return gate;
}

TEST_CASE("a single output far from those before is rejected, and the next good one accepted") {
    JumpGate<1> gate = ready_gate(500);
    CHECK(gate.jumps({force(500) + 12}, 1000 * ms));
    CHECK(gate.count() == 1);
    CHECK_FALSE(gate.jumps({force(501)}, 1002 * ms));
}

TEST_CASE("a real jump of the force is accepted after four consistent outputs") {
    JumpGate<1> gate = ready_gate(500);
    for (int tick = 500; tick < 510; ++tick) {
        CHECK(gate.jumps({force(tick) + 12}, 2 * ms * tick) == (tick < 503));
    }
}

TEST_CASE("after a silence, three consistent outputs are required") {
    JumpGate<1> gate = ready_gate(500);
    CHECK(gate.jumps({100}, 2 * ms * 510));
    CHECK(gate.jumps({force(511)}, 2 * ms * 511));
    CHECK(gate.jumps({force(512)}, 2 * ms * 512));
    CHECK_FALSE(gate.jumps({force(513)}, 2 * ms * 513));
}

TEST_CASE("a quiet output that changes by a count now and then does not jump") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double count = 0.05;
    for (const double noise_counts : {0.1, 0.2, 0.3, 0.5, 1.0}) {
        std::normal_distribution<double> noise(0, noise_counts);
        JumpGate<1> gate(6 * ms);
        for (int tick = 0; tick < 10'000; ++tick) {
            const double counts = 40 * std::sin(2e-4 * tick) + noise(engine);
            CAPTURE(noise_counts, tick);
            REQUIRE_FALSE(gate.jumps({count * std::round(counts)}, 2 * ms * tick));
        }
    }
}

TEST_CASE("a jump to identical outputs is rejected") {
    JumpGate<1> gate = ready_gate(500);
    for (int tick = 500; tick < 520; ++tick) {
        CHECK(gate.jumps({force(500) + 12}, 2 * ms * tick));
    }
    for (int tick = 520; tick < 526; ++tick) { // the sensor is no longer frozen
        CHECK(gate.jumps({force(tick) + 12}, 2 * ms * tick) == (tick < 522));
    }
}

} // namespace jump_test
