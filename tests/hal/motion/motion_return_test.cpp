// SPDX-License-Identifier: Apache-2.0
// Good joints that must be trusted again, and similar faulty encoders that must not.
#include "tests/hal/motion/watched_joint.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace motion_return_test {

using namespace watched_joint;

TEST_CASE("zeros of unknown time do not lose a joint that continues its motion") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    joint.gate.glance(Watched::reading(300, zero_rad, true));
    joint.gate.glance(Watched::reading(301, zero_rad, true));
    joint.gate.glance(Watched::reading(302, truth(302)));
    CHECK(joint.trusted(303, 700) > 150);
}

TEST_CASE("after a silence, readings towards the encoder's zero are no restart, readings away from it are") {
    for (const double velocity : {0.5, -0.5}) { // rad/s
        for (const bool restarts : {false, true}) {
            CAPTURE(velocity, restarts);
            Watched joint;
            const auto way = [&](int tick) { return velocity * 2e-3 * (tick - 400); };
            int trusted = 0;
            for (int tick = 0; tick < 900; ++tick) {
                const double counted_rad = restarts && tick >= 399 ? way(tick + 2) : way(tick);
                const bool silent = tick >= 340 && tick < 399;
                trusted +=
                    !silent && joint.take(tick, zero_rad + counted_rad) == Reason::ok && tick >= 399 ? 1 : 0;
            }
            CHECK((trusted > 250) == !restarts);
            CHECK((trusted == 0) == restarts);
        }
    }
}

TEST_CASE("a joint trusted at a wrong position after a long silence is trusted again at the earlier one") {
    Watched joint;
    const auto held_rad = [](int tick) { return 0.2 + 0.01 * std::sin(0.02 * tick); };
    for (int tick = 0; tick < 300; ++tick) {
        joint.take(tick, held_rad(300) - 6e-4 * (300 - tick)); // stops soon afterwards
    }
    int elsewhere = 0;
    for (int tick = 1800; tick < 1880; ++tick) { // readings of the neighbouring joint
        elsewhere += joint.take(tick, held_rad(tick) + 0.8) == Reason::ok ? 1 : 0;
    }
    REQUIRE(elsewhere > 50);
    int trusted = 0;
    for (int tick = 1880; tick < 2400; ++tick) {
        trusted += joint.take(tick, held_rad(tick)) == Reason::ok ? 1 : 0;
    }
    CHECK(trusted > 300);
}

TEST_CASE("after a clock step, an unexplained position needs 200 readings, and the zero is rejected") {
    for (const double off_rad : {-0.4, 0.2, zero_rad - truth(302)}) {
        CAPTURE(off_rad);
        Watched joint;
        REQUIRE(joint.trusted(0, 300) == 291);
        joint.gate.forget_time();
        CHECK(joint.trusted(302, 500, off_rad) == 0);
        const bool at_zero = off_rad == zero_rad - truth(302);
        CHECK((joint.trusted(500, 700, off_rad) > 150) == !at_zero);
    }
}

TEST_CASE("one more reading of another joint, with a few lost, does not lose the joint") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    REQUIRE(joint.trusted(300, 400, 1.2) == 0); // readings of the neighbouring joint
    joint.trusted(400, 428);
    joint.take(428, truth(400) + 1.2);
    CHECK(joint.trusted(432, 1000) > 300);
}

TEST_CASE("a slow joint is not mistaken for earlier readings with a wrong bit") {
    Watched joint;
    const auto slow_rad = [](int tick) { return 0.2 + 2e-3 * (tick - 300); };
    int trusted = 0;
    for (int tick = 0; tick < 900; ++tick) {
        const bool off = (tick >= 300 && tick < 320) || (tick >= 340 && tick < 343);
        const double off_rad = off ? 0.046 : 0; // as far as it moves from 320 to 343
        trusted += joint.take(tick, slow_rad(tick) + off_rad) == Reason::ok && tick >= 400 ? 1 : 0;
    }
    CHECK(trusted > 300);
}

TEST_CASE("after very many wrong readings, a few lost ones do not restore the encoder") {
    for (const int refused : {100, 260}) {
        CAPTURE(refused);
        Watched joint;
        REQUIRE(joint.trusted(0, 300) == 291);
        REQUIRE(joint.trusted(300, 300 + refused, 0.08) == 0);
        const int trusted = joint.trusted(305 + refused, 540 + refused, 0.11); // further than it accelerates
        CHECK((trusted == 0) == (refused > 200));
    }
}

TEST_CASE("a joint that moves to its zero while its device sends zeros is trusted there") {
    Watched joint;
    const auto way_rad = [](int tick) { return zero_rad - 0.024 + 3e-3 * (tick - 365); };
    int trusted = 0;
    for (int tick = 0; tick < 700; ++tick) {
        const bool zeros = tick >= 300 && tick < 365;
        const double moved_rad = tick < 400 ? way_rad(tick) : way_rad(400) + 1e-4 * (tick - 400);
        const EncoderReading reading = Watched::reading(tick, zeros ? zero_rad : moved_rad, zeros);
        trusted += joint.gate.take(reading).reason == Reason::ok && tick >= 400 ? 1 : 0;
    }
    CHECK(trusted > 50);
}

TEST_CASE("a joint that passes near a zero just sent by its device is not lost by wrong readings") {
    Watched joint;
    const auto way_rad = [](int tick) { return zero_rad + 0.016 - 1e-3 * (tick - 364); };
    int trusted = 0;
    for (int tick = 0; tick < 900; ++tick) {
        const bool zeros = tick >= 250 && tick < 361;
        const bool silent = tick == 363;
        const double off_rad = tick == 361 || tick == 362 ? 0.009 - (way_rad(tick) - zero_rad) : 0;
        const EncoderReading reading =
            Watched::reading(tick, zeros ? zero_rad : way_rad(tick) + off_rad, zeros);
        trusted += !silent && joint.gate.take(reading).reason == Reason::ok && tick >= 400 ? 1 : 0;
    }
    CHECK(trusted > 200);
}

} // namespace motion_return_test
