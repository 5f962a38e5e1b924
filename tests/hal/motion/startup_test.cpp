// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/motion/startup.hpp"

#include "tests/support/catch.hpp"

namespace qualification_test {

using dfdyn::hal::StartupGate;

constexpr StartupGate::Config quick{.readings = 3, .zero_readings = 20};

TEST_CASE("a source qualifies after the required number of readings") {
    StartupGate gate(quick);
    CHECK_FALSE(gate.qualified(false));
    CHECK_FALSE(gate.qualified(false));
    CHECK(gate.qualified(false));
    CHECK(gate.qualified(true)); // zeros are accepted from now on
}

TEST_CASE("zeros after power-on do not count") {
    StartupGate gate(quick);
    for (int i = 0; i < 19; ++i) {
        CHECK_FALSE(gate.qualified(true));
    }
    CHECK_FALSE(gate.qualified(false));
    CHECK_FALSE(gate.qualified(false));
    CHECK(gate.qualified(false));
}

TEST_CASE("very many consecutive zeros are accepted") {
    StartupGate gate(quick);
    for (int i = 1; i < 20; ++i) {
        CHECK_FALSE(gate.qualified(true));
    }
    CHECK(gate.qualified(true));
    CHECK(gate.qualified(false));
}

TEST_CASE("a source must qualify again after a silence") {
    StartupGate gate(quick);
    gate.restart(); // no effect: nothing is qualified yet
    CHECK(gate.restarts() == 0);
    for (int i = 0; i < 3; ++i) {
        gate.qualified(false);
    }
    gate.restart();
    CHECK(gate.restarts() == 1);
    CHECK_FALSE(gate.qualified(false));
    CHECK_FALSE(gate.qualified(true));
    CHECK_FALSE(gate.qualified(false));
    CHECK(gate.qualified(false));
}

} // namespace qualification_test
