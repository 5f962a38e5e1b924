// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/friction_hysteresis.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace friction_hysteresis_test {

using Hysteresis = dfdyn::FrictionHysteresis<double>;

constexpr double period_s = 0.001;

/// A joint with a model whose friction depends on the sign of its velocity.
struct Joint {
    Hysteresis hysteresis;
    double lowest = 0, highest = 0;

    void move(double velocity, double duration_s) {
        const double direction = velocity > 0 ? 1 : velocity < 0 ? -1 : 0;
        for (int tick = 0; tick < std::lround(duration_s / period_s); ++tick) {
            hysteresis.follow(velocity * period_s, direction, period_s / Hysteresis::lag_s, period_s / 0.02);
            lowest = std::min(lowest, hysteresis.low());
            highest = std::max(highest, hysteresis.high());
        }
    }

    /// Forgets the extremes so far.
    void watch() { lowest = highest = 0; }
};

TEST_CASE("hysteresis explains no error of a joint that moves on", "[contacts]") {
    Joint joint;
    joint.move(0.5, 1);
    CHECK(joint.hysteresis.low() == Approx(0).margin(1e-6));
    CHECK(joint.hysteresis.high() == Approx(0).margin(1e-6));
}

TEST_CASE("a joint that stops may keep the friction of its last motion", "[contacts]") {
    for (const double velocity : {0.5, -0.5}) {
        Joint joint;
        joint.move(velocity, 1);
        joint.move(0, 1);
        CHECK(joint.hysteresis.high() == Approx(velocity > 0 ? 1 : 0).margin(1e-6));
        CHECK(joint.hysteresis.low() == Approx(velocity > 0 ? 0 : -1).margin(1e-6));
    }
}

TEST_CASE("a model that is late at a reversal has an error of the new direction until it follows",
          "[contacts]") {
    Joint joint;
    joint.move(0.5, 1);
    joint.watch();
    joint.move(-0.5, 1);
    CHECK(joint.lowest < -1);
    CHECK(joint.lowest > -2);
    CHECK(joint.highest == Approx(0).margin(1e-3));
    CHECK(joint.hysteresis.low() == Approx(0).margin(1e-6));
}

TEST_CASE("an encoder's count back hardly changes the friction, but reverses the model's", "[contacts]") {
    Joint joint;
    joint.move(0.5, 1);
    joint.watch();
    joint.move(-0.1 * Hysteresis::presliding / period_s, period_s); // a count in one tick
    for (int tick = 0; tick < 300; ++tick) {
        joint.hysteresis.follow(0, -1, period_s / Hysteresis::lag_s, period_s / 0.02);
    }
    CHECK(joint.hysteresis.high() > 1.8);
    CHECK(joint.lowest == Approx(0).margin(1e-3));
}

TEST_CASE("the range of hysteresis contains zero and ends within twice the friction", "[contacts]") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> step(0, 3 * Hysteresis::presliding);
    std::uniform_real_distribution<double> direction(-1, 1);
    Hysteresis hysteresis;
    for (int tick = 0; tick < 100'000; ++tick) {
        hysteresis.follow(step(engine), direction(engine), 0.1, 0.2);
        REQUIRE(hysteresis.low() <= 0);
        REQUIRE(hysteresis.low() >= -2);
        REQUIRE(hysteresis.high() >= 0);
        REQUIRE(hysteresis.high() <= 2);
    }
    hysteresis.begin();
    CHECK(hysteresis.high() - hysteresis.low() == 0);
}

} // namespace friction_hysteresis_test
