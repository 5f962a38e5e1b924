// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/lugre_friction.hpp"

#include "tests/support/catch.hpp"

#include <cmath>

namespace lugre_friction_test {

using dfdyn::tools::LuGreFriction;
using dfdyn::tools::LuGreParameters;

LuGreParameters parameters() {
    LuGreParameters result;
    result.stiffness = 1000;
    result.damping = 2;
    result.viscous = 0.4;
    result.coulomb = 1;
    result.breakaway = 1.5;
    result.stribeck_velocity = 0.05;
    return result;
}

TEST_CASE("LuGre friction converges to the Stribeck curve at every velocity in both directions") {
    for (const double velocity : {-2.0, -0.1, -0.03, 0.001, 0.02, 0.05, 0.3, 5.0}) {
        LuGreFriction friction(parameters());
        for (int i = 0; i < 1000; ++i) { // forty times the deflection of the bristles
            friction.advance(velocity, 6e-5 / std::abs(velocity));
        }
        const double ratio = velocity / 0.05;
        const double level = 1 + 0.5 * std::exp(-ratio * ratio);
        CAPTURE(velocity);
        CHECK(friction.torque(velocity) ==
              Approx(std::copysign(level, velocity) + 0.4 * velocity).epsilon(1e-6));
    }
}

TEST_CASE("before it breaks away LuGre friction is a spring with the bristles' stiffness") {
    LuGreFriction friction(parameters());
    const double velocity = 1e-4;
    double moved = 0;
    for (int i = 0; i < 100; ++i) {
        friction.advance(velocity, 1e-3);
        moved += velocity * 1e-3;
    }
    // To first order, the spring yields by the ratio of its torque to the break-away torque.
    CHECK(moved < 1e-2 * 1.5 / 1000);
    CHECK(friction.torque(0) == Approx(1000 * moved).epsilon(1e-2));
    // It returns when the joint does.
    for (int i = 0; i < 100; ++i) {
        friction.advance(-velocity, 1e-3);
    }
    CHECK(std::abs(friction.torque(0)) < 1e-2 * 1000 * moved);
}

TEST_CASE("the integration of the bristles is exact for one long step as for many short ones") {
    LuGreFriction once(parameters());
    LuGreFriction often(parameters());
    once.advance(0.3, 0.01);
    for (int i = 0; i < 1000; ++i) {
        often.advance(0.3, 1e-5);
    }
    CHECK(once.torque(0.3) == Approx(often.torque(0.3)).epsilon(1e-10));
}

TEST_CASE("friction that suddenly becomes smaller causes no peak of the torque") {
    for (const double direction : {1.0, -1.0}) {
        for (const double factor : {0.0, 1e-6, 0.1}) {
            for (const double velocity : {0.3, 1e-3, -0.3}) {
                LuGreFriction friction(parameters());
                friction.advance(direction * 0.01, 1); // at the level
                friction.set_factor(factor);
                CAPTURE(direction, factor, velocity);
                // The level, the damping of bristles that slip or reverse, and viscous friction.
                const double level = 1.5 * factor + 1e-8;
                CHECK(std::abs(friction.deflection()) <= level / 1000);
                CHECK(std::abs(friction.torque(velocity)) <=
                      level + 2 * std::abs(velocity) * (1 + 1.5) + 0.4 * factor * std::abs(velocity));
            }
        }
    }
}

TEST_CASE("a factor changes no deflection within the new level in either direction") {
    LuGreParameters uneven = parameters();
    uneven.negative_excess = 0.4;
    LuGreFriction friction(uneven);
    friction.advance(-5, 1); // to -(1 + 0.4) / 1000, of a break-away level of 1.5 + 0.4
    const double deflection = friction.deflection();
    CHECK(deflection == Approx(-1.4e-3));
    for (const double factor : {1.0, 0.8, 2.0}) {
        friction.set_factor(factor);
        CHECK(friction.deflection() == deflection);
    }
}

TEST_CASE("without bristles only viscous friction remains") {
    LuGreParameters viscous;
    viscous.viscous = 0.7;
    LuGreFriction friction(viscous);
    friction.advance(2, 1);
    CHECK(friction.torque(2) == 1.4);
    CHECK(friction.deflection() == 0);
}

} // namespace lugre_friction_test
