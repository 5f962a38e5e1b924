// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/frozen_wrench.hpp"

#include "tests/support/catch.hpp"

namespace frozen_test {

using Gate = dfdyn::hal::FrozenWrenchGate<3>;

TEST_CASE("a sensor that repeats its values is frozen from the limit on, until they change") {
    Gate gate(4);
    const Gate::Raw stuck{7, -3, 0};
    for (int reading = 1; reading <= 10; ++reading) {
        CHECK(gate.frozen(stuck) == (reading >= 4));
    }
    CHECK(gate.count() == 1);
    for (int reading = 1; reading <= 10; ++reading) {
        CHECK(gate.frozen({7, -3, 1}) == (reading >= 6)); // two may be flipped bits
    }
    CHECK(gate.count() == 2);
}

TEST_CASE("a flipped bit does not end a frozen sensor's row") {
    Gate gate(4);
    const Gate::Raw stuck{7, -3, 0};
    for (int reading = 1; reading <= 4; ++reading) {
        gate.frozen(stuck);
    }
    CHECK_FALSE(gate.frozen({7, -3, 1}));
    CHECK(gate.frozen(stuck));
    CHECK(gate.count() == 1);
}

TEST_CASE("a sensor that freezes again at its frozen values after three flipped bits is rejected") {
    Gate gate(4);
    const Gate::Raw stuck{7, -3, 0};
    for (int reading = 1; reading <= 4; ++reading) {
        gate.frozen(stuck);
    }
    for (std::int32_t bit = 1; bit <= 4; bit *= 2) {
        CHECK_FALSE(gate.frozen({7, -3, bit}));
    }
    CHECK(gate.frozen(stuck));
    CHECK(gate.count() == 1);
    for (int reading = 1; reading <= 11; ++reading) { // good for some readings
        CHECK_FALSE(gate.frozen({reading, reading, 5}));
    }
    CHECK_FALSE(gate.frozen(stuck));
}

TEST_CASE("a sensor that sometimes repeats a reading is not frozen") {
    Gate gate(4);
    for (int reading = 0; reading < 1000; ++reading) {
        CHECK_FALSE(gate.frozen({reading / 3, 0, 0}));
    }
    CHECK(gate.count() == 0);
}

TEST_CASE("three equal readings that span the limit are frozen, despite others between them") {
    dfdyn::hal::FrozenWrenchGate<3> gate(5, 2'000'000);
    const Gate::Raw stuck{7, -3, 0};
    CHECK_FALSE(gate.frozen(stuck, 0));
    CHECK_FALSE(gate.frozen(stuck, 2'000'000));
    CHECK_FALSE(gate.frozen({7, -3, 1}, 4'000'000));
    CHECK(gate.frozen(stuck, 8'000'000)); // one was lost
    CHECK(gate.count() == 1);
}

TEST_CASE("repeated zeros are frozen like any other value") {
    Gate gate(2);
    CHECK_FALSE(gate.frozen({0, 0, 0}));
    CHECK(gate.frozen({0, 0, 0}));
}

TEST_CASE("a coarse sensor that returns to its frozen values is accepted after some readings") {
    for (const int pause : {3, 4}) { // other values between them
        for (const int times : {1, 2}) {
            CAPTURE(pause, times);
            Gate gate(4);
            const Gate::Raw values{7, -3, 0};
            for (int reading = 1; reading <= 4; ++reading) {
                gate.frozen(values);
            }
            int refused = 0;
            for (int round = 0; round < 100; ++round) {
                for (int other = 1; other <= pause; ++other) {
                    CHECK_FALSE(gate.frozen({7, -3, other}));
                }
                for (int time = 0; time < times; ++time) {
                    refused += gate.frozen(values) ? 1 : 0;
                }
            }
            CHECK(refused <= 6);
            CHECK(gate.count() == 1);
        }
    }
}

} // namespace frozen_test
