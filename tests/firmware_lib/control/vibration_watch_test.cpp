// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/control/vibration_watch.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace vibration_watch_test {

using namespace dfdyn;

using Watch = VibrationWatch<double, 1>;
constexpr double swing = 2;

/// Sine of this amplitude on a slow motion.
struct Sine {
    double hz, amplitude, rate_hz;

    [[nodiscard]] double at(int tick) const {
        const double phase = 2 * std::numbers::pi * tick / rate_hz;
        return 10 * std::sin(0.5 * phase) + amplitude * std::sin(hz * phase);
    }
};

/// Number of times that the watch finds a vibration in 10 s.
int found(const Sine& sine) {
    Watch watch({}, 1 / sine.rate_hz);
    int times = 0;
    for (int tick = 0; tick < 10 * sine.rate_hz; ++tick) {
        times += watch.vibrates(0, sine.at(tick), swing) ? 1 : 0;
    }
    return times;
}

TEST_CASE("a vibration is found every four periods at each frequency and rate of the loop") {
    const double hz = GENERATE(8.0, 12.0, 25.0, 50.0, 80.0);
    const double rate_hz = GENERATE(250.0, 1000.0, 4000.0);
    const double amplitude = rate_hz > 8 * hz ? 1.5 * swing : 4 * swing; // half a period of four ticks
    CAPTURE(hz, rate_hz);
    const int times = found({hz, amplitude, rate_hz});
    CHECK(times <= 10 * hz / 4);
    CHECK(times >= 10 * hz / 4 - 3);
}

TEST_CASE("motions, single steps and vibrations smaller than the swing are no vibration") {
    CHECK(found({25, 0.4 * swing, 1000}) == 0);
    CHECK(found({2, 20 * swing, 1000}) == 0);
    CHECK(found({4, 20 * swing, 1000}) == 0);
    Watch watch({}, 1e-3);
    for (int tick = 0; tick < 20'000; ++tick) { // friction at a reversal, each quarter of a second
        REQUIRE_FALSE(watch.vibrates(0, tick / 250 % 2 == 0 ? 10 : -10, swing));
    }
}

TEST_CASE("noise and an encoder's counts are no vibration") {
    DFDYN_SEEDED_ENGINE(engine);
    const double height = GENERATE(0.2, 0.4, 0.6); // standard deviation, by the swing
    CAPTURE(height);
    std::normal_distribution<double> noise(0, height * swing);
    std::uniform_int_distribution<int> pause(4, 60);
    Watch noisy({}, 1e-3), counted({}, 1e-3);
    int next = 0;
    int found = 0;
    for (int tick = 0; tick < 1'000'000; ++tick) {
        found += noisy.vibrates(0, noise(engine), swing) ? 1 : 0;
        next = tick > next + 2 ? tick + pause(engine)
                               : next; // the rate's window contains a count for three ticks
        found += counted.vibrates(0, tick >= next ? 1.9 * swing : 0, swing) ? 1 : 0;
    }
    CHECK(found == 0);
}

TEST_CASE("smooth vibrations count from the swing on, jagged ones from three swings on") {
    const double smooth = GENERATE(1.5, 2.0, 2.5); // from turn to turn, by the swing
    CHECK(found({25, 0.5 * smooth * swing, 1000}) > 20);
    // turns every other tick, half of the way in each: the sine of 250 Hz at 1 kHz
    CHECK(found({250, 0.5 * smooth * swing, 1000}) == 0);
    CHECK(found({250, 1.7 * swing, 1000}) > 500);
}

TEST_CASE("a vibration begins anew after a pause and after a restart") {
    const Sine sine{25, 1.5 * swing, 1000};
    const bool restarts = GENERATE(false, true);
    const int pause = GENERATE(20, 101); // ticks; the watch waits 0.1 s for a turn
    CAPTURE(restarts, pause);
    Watch watch({}, 1 / sine.rate_hz);
    int tick = 0;
    while (tick < 1000 && !watch.vibrates(0, sine.at(tick), swing)) {
        ++tick;
    }
    REQUIRE(tick < 1000);
    const int first = tick;              // eight turns from here to the next vibration
    for (; tick < first + 130; ++tick) { // six of them
        REQUIRE_FALSE(watch.vibrates(0, sine.at(tick), swing));
    }
    if (restarts) {
        watch.restart();
    }
    for (int missing = 0; missing < pause; ++missing) {
        watch.pass(0);
    }
    const int again = tick;
    while (tick < 2000 && !watch.vibrates(0, sine.at(tick), swing)) {
        ++tick;
    }
    CHECK(tick - again < 250);
    CHECK((tick - again > 130) == (restarts || pause > 100));
}

TEST_CASE("without a swing nothing is found") {
    const double none = GENERATE(0.0, -1.0, std::numeric_limits<double>::quiet_NaN());
    CAPTURE(none);
    Watch watch({}, 1e-3);
    for (int tick = 0; tick < 1000; ++tick) {
        REQUIRE_FALSE(watch.vibrates(0, std::sin(0.2 * tick), none));
    }
}

TEST_CASE("each joint is watched by itself, in float too") {
    VibrationWatch<float, 2> watch({}, 1e-3F);
    const Sine sine{25, 1.5 * swing, 1000};
    int times[] = {0, 0};
    for (int tick = 0; tick < 10'000; ++tick) {
        times[0] += watch.vibrates(0, static_cast<float>(sine.at(tick)), swing) ? 1 : 0;
        times[1] += watch.vibrates(1, static_cast<float>(10 * std::sin(1e-3 * tick)), swing) ? 1 : 0;
    }
    CHECK(times[0] >= 60);
    CHECK(times[1] == 0);
}

TEST_CASE("a vibration is found again after torques that are not numbers") {
    Watch watch({}, 1e-3);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double torque : {nan, infinity, nan, -infinity, infinity, nan}) {
        CHECK_FALSE(watch.vibrates(0, torque, swing));
    }
    const Sine sine{25, 1.5 * swing, 1000};
    int times = 0;
    for (int tick = 0; tick < 1000; ++tick) {
        times += watch.vibrates(0, sine.at(tick), swing) ? 1 : 0;
    }
    CHECK(times >= 4);
}

} // namespace vibration_watch_test
