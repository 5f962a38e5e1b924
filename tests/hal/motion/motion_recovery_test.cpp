// SPDX-License-Identifier: Apache-2.0
// Joints that are trusted again after a fault, and those that are not.
#include "tests/hal/motion/watched_joint.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>

namespace motion_recovery_test {

using namespace watched_joint;

TEST_CASE("after a short trial, a jump back to the earlier motion is accepted") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    REQUIRE(joint.trusted(400, 440, 0.15) > 0); // the joint can have moved there during the silence
    CHECK(joint.trusted(440, 600) == 0);        // a jump back: 200 readings are needed
    CHECK(joint.trusted(600, 700) > 50);
}

TEST_CASE("a jump soon after a silence is rejected despite earlier trusted readings") {
    for (const double jump_rad : {0.1, -0.1, 0.3}) {
        CAPTURE(jump_rad);
        Watched joint;
        REQUIRE(joint.trusted(0, 300) == 291);
        REQUIRE(joint.trusted(400, 450) > 30);
        CHECK(joint.trusted(450, 750, jump_rad) == 0); // a bit is stuck
        CHECK(joint.trusted(750, 1100) > 100);
    }
}

TEST_CASE("after a long trial, a jump back to the earlier motion is rejected") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    REQUIRE(joint.trusted(400, 800, 0.1) > 300);
    CHECK(joint.trusted(800, 1400) == 0);
}

TEST_CASE("the reverse of an earlier jump to the encoder's zero is no restart") {
    int tick = 0;
    Watched joint;
    const auto passing = [](int at) { return zero_rad + 1e-3 * (at - 400); };
    for (; tick < 360; ++tick) {
        joint.take(tick, passing(tick));
    }
    for (; tick < 400; ++tick) { // a stuck bit, until the number changes its sign
        CHECK(joint.take(tick, passing(tick) - 0.05) != Reason::ok);
    }
    Reason last = Reason::ok;
    for (; tick < 700; ++tick) {
        last = joint.take(tick, passing(tick));
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a jump from another position to the encoder's zero is a restart") {
    int tick = 0;
    Watched joint;
    for (; tick < 360; ++tick) {
        joint.take(tick, zero_rad + 1e-3 * (tick - 400));
    }
    for (; tick < 900; ++tick) {
        CHECK(joint.take(tick, zero_rad + 1e-3 * (tick - 360)) != Reason::ok);
    }
}

TEST_CASE("a restart that reverses a jump of minutes before is still a restart") {
    const auto truth_rad = [](int tick) { return zero_rad + 0.05 + 0.01 * std::sin(0.02 * tick); };
    constexpr int restart = 62832; // 200 turns of the sine
    Watched joint;
    int trusted = 0;
    for (int tick = 0; tick < restart; ++tick) {
        const bool zeros = tick >= 588 && tick < 628;
        trusted += joint.take(tick, zeros ? zero_rad : truth_rad(tick)) == Reason::ok ? 1 : 0;
    }
    REQUIRE(trusted > restart - 300);
    for (int tick = restart; tick < restart + 600; ++tick) {
        if (tick < restart + 50 || tick >= restart + 150) { // after the silence the joint could be there
            CHECK(joint.take(tick, zero_rad + truth_rad(tick) - truth_rad(restart)) != Reason::ok);
        }
    }
}

TEST_CASE("at 100 Hz, the interval between two readings is too short for a restart") {
    constexpr std::int64_t period_100_hz = 10'000'000;
    MotionGate gate({.limits = {5, 20},
                     .range = {-4, 4},
                     .max_age_ns = 3 * period_100_hz,
                     .period_ns = period_100_hz,
                     .jitter_ns = period_100_hz / 10,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    Reason last = Reason::qualifying;
    for (int tick = -100; tick < 300; ++tick) { // impact at the encoder's zero
        const double from_zero_rad = -1e-2 * std::abs(tick);
        last = gate.take({.stamp_ns = (tick + 100) * period_100_hz,
                          .position_rad = zero_rad + from_zero_rad,
                          .step_rad = 1e-5,
                          .from_zero_rad = from_zero_rad})
                   .reason;
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a small jump is accepted after 200 readings, also with a missing one") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    CHECK(joint.trusted(302, 480, 0.009) == 0);
    CHECK(joint.trusted(480, 600, 0.009) > 50);
}

TEST_CASE("a jump within the velocity limit during qualification requires 200 readings") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    CHECK(joint.trusted(306, 314) == 0);
    CHECK(joint.trusted(314, 480, 0.009) == 0);
    CHECK(joint.trusted(480, 600, 0.009) > 0);
}

TEST_CASE("after 500 rejected readings, a loss by a jump ends only with the reverse jump") {
    for (const int refused : {300, 320, 450, 490, 510, 1000}) {
        for (const double left_rad : {0.0, 0.1}) {
            CAPTURE(refused, left_rad);
            Watched joint;
            REQUIRE(joint.trusted(0, 300) == 291);
            CHECK(joint.trusted(300, 300 + refused, 0.3) == 0);
            const int trusted = joint.trusted(300 + refused, 1000 + refused, left_rad);
            CHECK((trusted > 400) == (refused < 500 || left_rad == 0));
            CHECK((trusted == 0) == (refused >= 500 && left_rad != 0));
        }
    }
}

TEST_CASE("after 500 rejected readings, a loss by a silence ends with a jump to a possible position") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    CHECK(joint.trusted(310, 1000, 1) == 0);
    CHECK(joint.trusted(1000, 1400) > 100);
}

TEST_CASE("a loss ends with the reverse of its own first jump, also if that led beyond the range") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    CHECK(joint.trusted(300, 340, 0.3) == 0);
    REQUIRE(joint.trusted(340, 1570) > 1000);
    CHECK(joint.trusted(1570, 2180, 2.69) == 0); // beyond 3 rad after five readings
    CHECK(joint.trusted(2180, 2600) > 100);
}

/// Readings within the range (3 rad) and beyond it, without a jump.
bool is_trusted_after(double (*position_rad)(int tick), int ticks) {
    Watched joint;
    Reason last = Reason::ok;
    for (int tick = 0; tick < ticks; ++tick) {
        last = joint.take(tick, position_rad(tick));
    }
    CHECK_FALSE(joint.gate.lost());
    return last == Reason::ok;
}

TEST_CASE("a joint that moved beyond its range without a jump is trusted after it returned") {
    CHECK(is_trusted_after([](int tick) { return 2.9945 + 1e-3 * std::min(tick, 30 - tick); }, 530));
    const auto at_its_end = [](int tick) { // flickers by two counts
        return tick < 100 ? 3 + 1e-5 * (tick % 2 == 0 ? -1 : 1) : 3 - 5e-4 * (tick - 99);
    };
    CHECK(is_trusted_after(at_its_end, 300));
    const auto often_beyond = [](int tick) { // for 20 readings, then within for six
        const int moved = std::clamp(tick - 100, 0, 260);
        return 3.00075 - 1e-3 * std::cos(0.2416609733530613 * moved);
    };
    CHECK(is_trusted_after(often_beyond, 860));
}

TEST_CASE("a jump soon after a silence is a contradiction, also with a lost reading") {
    Watched joint;
    REQUIRE(joint.trusted(0, 300) == 291);
    CHECK(joint.trusted(400, 403) == 0);
    CHECK(joint.take(403, truth(403) + 0.14) != Reason::ok); // a replay begins
    CHECK(joint.trusted(405, 590, 0.14) == 0);
}

TEST_CASE("a displacement is rejected if the limits and both velocities exclude it") {
    Watched joint;
    const auto slow = [](int tick) { return 0.1 + 2e-5 * tick; };
    for (int tick = 0; tick < 300; ++tick) {
        joint.take(tick, slow(tick));
    }
    // 20 rad/s² allow 0.4 rad in 0.2 s, but only 0.2 rad if the joint ends as slowly as it began
    int trusted = 0;
    for (int tick = 400; tick < 900; ++tick) {
        trusted += joint.take(tick, slow(tick) + 0.25) == Reason::ok ? 1 : 0;
    }
    CHECK(trusted == 0);
}

TEST_CASE("after a silence, a slow joint is trusted at a position that its limits allow") {
    Watched joint;
    const auto slow = [](int tick) { return 0.1 + 2e-5 * tick; };
    int trusted = 0;
    for (int tick = 0; tick < 900; ++tick) {
        const bool silent = tick >= 300 && tick < 400;
        trusted += !silent && joint.take(tick, slow(tick) + (tick < 300 ? 0 : 0.18)) == Reason::ok ? 1 : 0;
    }
    CHECK(trusted > 700);
}

TEST_CASE("a run that begins too far away with unknown times is rejected") {
    const auto trusted_after = [](double off_rad) {
        Watched joint;
        REQUIRE(joint.trusted(0, 300) == 291);
        for (int tick = 350; tick < 700; ++tick) { // 0.1 s later, at 5 rad/s at most
            joint.gate.glance(Watched::reading(tick, truth(tick) + off_rad));
        }
        return joint.trusted(700, 1200, off_rad);
    };
    CHECK(trusted_after(-1) == 0);
    CHECK(trusted_after(-0.05) > 400);
}

/// Returns how many of the last 1000 of 2000 correct readings are trusted.
int trusted_later(Watched& joint, int from) {
    joint.trusted(from, from + 1000);
    return joint.trusted(from + 1000, from + 2000);
}

TEST_CASE("zeros of a device that is not ready do not lose the joint") {
    for (const bool untimed : {false, true}) {
        CAPTURE(untimed);
        Watched joint;
        REQUIRE(joint.trusted(0, 300) == 291);
        for (int tick = 300; tick < 384; ++tick) {
            joint.gate.interrupt(Watched::reading(tick, zero_rad, true));
        }
        for (int tick = 384; tick < 417; ++tick) {
            const EncoderReading good = Watched::reading(tick, truth(tick));
            untimed ? joint.gate.glance(good) : joint.gate.interrupt(good);
        }
        CHECK(trusted_later(joint, 417) == 1000);
    }
}

TEST_CASE("one wrong reading of unknown time, or of a device that is not ready, does not lose the joint") {
    for (const bool untimed : {false, true}) {
        for (const int off : {300, 301, 302, 340, 374}) {
            for (const double off_rad : {0.026, -0.026, 0.3, 1.0}) {
                CAPTURE(untimed, off, off_rad);
                Watched joint;
                REQUIRE(joint.trusted(0, 300) == 291);
                for (int tick = 300; tick < 375; ++tick) {
                    const EncoderReading one =
                        Watched::reading(tick, truth(tick) + (tick == off ? off_rad : 0));
                    untimed ? joint.gate.glance(one) : joint.gate.interrupt(one);
                }
                CHECK(trusted_later(joint, 375) == 1000);
            }
        }
    }
}

TEST_CASE("readings of unknown time that continue from the encoder's zero show a restart") {
    Watched joint;
    for (int tick = 0; tick < 200; ++tick) {
        joint.take(tick, 0.3 + 1e-4 * tick);
    }
    const auto counted = [&](int tick) { return zero_rad + 1.8e-3 * (tick - 300); };
    joint.take(300, counted(300));
    joint.take(301, counted(301));
    for (int tick = 304; tick < 500; ++tick) { // late answers
        joint.gate.glance(Watched::reading(tick, counted(tick)));
    }
    Reason last = Reason::ok;
    for (int tick = 500; tick < 900; ++tick) {
        last = joint.take(tick, counted(tick));
    }
    CHECK(last == Reason::position_lost);
}

} // namespace motion_recovery_test
