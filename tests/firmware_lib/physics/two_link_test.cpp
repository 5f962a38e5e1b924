// SPDX-License-Identifier: Apache-2.0
// Compares the regressor with the textbook equations of the planar two-link arm.
#include "dfdyn/physics/rigid_body.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace two_link_test {

using namespace dfdyn;

constexpr double gravity = 9.81;
constexpr double length = 0.4; ///< of the first link

using Arm = Chain<2>;

/// Two axes along z, gravity along -y.
constexpr Arm::Constants<double> chain{{{{{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, {0, 0, 1}, false},
                                         {{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {length, 0, 0}}, {0, 0, 1}, false}}},
                                       {0, -gravity, 0},
                                       {}};

/// Planar parameters: mass, first moment, and moment of inertia about the joint's axis.
struct PlanarBody {
    double mass, first_x, first_y, inertia;
};

struct Torques {
    double first, second;
};

/// Lagrange's equations with the kinetic energy T = ½ I₁ q̇₁² + ½ m₂ l² q̇₁² + ½ I₂ ω² + l q̇₁ ω h, ω = q̇₁ +
/// q̇₂, h = mx₂ cos q₂ - my₂ sin q₂, and the heights of the centres of mass.
Torques by_hand(const PlanarBody& one, const PlanarBody& two, const double* xi) {
    const double q1 = xi[0];
    const double v1 = xi[1];
    const double a1 = xi[2];
    const double q2 = xi[3];
    const double v2 = xi[4];
    const double a2 = xi[5];
    const double h = two.first_x * std::cos(q2) - two.first_y * std::sin(q2);
    const double dh = -two.first_x * std::sin(q2) - two.first_y * std::cos(q2);
    const double lift2 = gravity * (two.first_x * std::cos(q1 + q2) - two.first_y * std::sin(q1 + q2));
    const double lift1 = gravity * (one.first_x * std::cos(q1) - one.first_y * std::sin(q1) +
                                    two.mass * length * std::cos(q1));
    const double second = two.inertia * (a1 + a2) + length * h * a1 - length * dh * v1 * v1 + lift2;
    const double first = (one.inertia + two.mass * length * length) * a1 + two.inertia * (a1 + a2) +
                         length * h * (2 * a1 + a2) + length * dh * v2 * (2 * v1 + v2) + lift1 + lift2;
    return {first, second};
}

TEST_CASE("a planar arm of two links has the torques of the textbook") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> number(-3, 3);
    for (int trial = 0; trial < 200; ++trial) {
        double parameters[20];
        double xi[6];
        for (double& parameter : parameters) {
            parameter = number(engine);
        }
        for (double& value : xi) {
            value = number(engine);
        }
        double psi[2 * 20];
        rigid_body_regressor<Arm>(chain, {}, xi, psi, 20);
        double torques[2] = {};
        for (int k = 0; k < 2; ++k) {
            for (int c = 0; c < 20; ++c) {
                torques[k] += psi[20 * k + c] * parameters[c];
            }
        }
        // Forces out of the plane, which the other parameters cause, act on no joint.
        const Torques expected =
            by_hand({parameters[0], parameters[1], parameters[2], parameters[9]},
                    {parameters[10], parameters[11], parameters[12], parameters[19]}, xi);
        CHECK(torques[0] == Approx(expected.first).epsilon(1e-9).margin(1e-11));
        CHECK(torques[1] == Approx(expected.second).epsilon(1e-9).margin(1e-11));
    }
}

TEST_CASE("a prismatic joint carries and accelerates the mass beyond it") {
    using Slider = Chain<1>;
    constexpr Slider::Constants<double> vertical{
        {{{{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}}, {0, 0, 1}, true}}}, {0, 0, -gravity}, {}};
    const double xi[] = {0.3, 5, 2};
    double psi[10];
    rigid_body_regressor<Slider>(vertical, {}, xi, psi, 10);
    CHECK(psi[0] == Approx(gravity + 2));
    for (int c = 1; c < 10; ++c) {
        CHECK(psi[c] == 0);
    }
}

} // namespace two_link_test
