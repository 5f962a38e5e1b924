// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/simulated_arm.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/simulation/small_arms.hpp"

#include <cmath>

namespace simulated_arm_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

double energy(const SimulatedArm& arm) {
    return arm.dynamics().energy(arm.configuration(), arm.state().velocity);
}

/// Largest relative deviation of the energy of an arm that falls freely for 4 s.
double energy_error(const Robot& robot, double step_s) {
    const auto n = static_cast<int>(robot.joints.size());
    SimulatedArm arm(robot, free_actuators(n), JointVector::Constant(n, 0.5));
    arm.apply(JointVector::Zero(n));
    const double start = energy(arm);
    double worst = 0;
    double swing = 0;
    for (double time_s = 0; time_s < 4; time_s += step_s) {
        arm.advance(step_s);
        const JointVector& velocity = arm.state().velocity;
        const double kinetic = 0.5 * velocity.dot(arm.dynamics().mass_matrix(arm.configuration()) * velocity);
        swing = std::max(swing, kinetic);
        worst = std::max(worst, std::abs(energy(arm) - start));
    }
    return worst / swing;
}

/// A random revolute chain with the masses of a real arm. A chain with prismatic joints would fall for ever.
Robot random_swing(std::mt19937_64& engine, int n) {
    Robot robot = random_robot(engine, n);
    for (RobotJoint& joint : robot.joints) {
        joint.prismatic = false;
    }
    return robot;
}

TEST_CASE("a free swing conserves energy with an error of at least fourth order in the step") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 3; ++trial) {
        const Robot robot = random_swing(engine, 2 + trial);
        const double coarse = energy_error(robot, 4e-3);
        const double fine = energy_error(robot, 2e-3);
        CAPTURE(trial, coarse, fine);
        CHECK(fine < coarse / 12);
        CHECK(energy_error(robot, 1.25e-4) < 1e-8);
    }
}

TEST_CASE("a pendulum swings with the period of the elliptic integral") {
    SimulatedArm arm(pendulum(1, 1), free_actuators(1), JointVector::Constant(1, 2));
    arm.apply(JointVector::Zero(1));
    double time_s = 0;
    while (arm.state().position[0] > 0) {
        arm.advance(1e-4);
        time_s += 1e-4;
    }
    time_s += arm.state().position[0] / -arm.state().velocity[0]; // interpolated back to the crossing
    const double quarter = std::comp_ellint_1(std::sin(1.0)) * std::sqrt(1 / 9.81);
    CHECK(time_s == Approx(quarter).epsilon(1e-6));
}

TEST_CASE("friction dissipates exactly the lost energy and holds the arm in the end") {
    ActuatorModel actuators = free_actuators(1);
    actuators.friction[0] = {500, 1, 0.1, 0.5, 0.8, 0.05};
    SimulatedArm arm(pendulum(1, 0.5), actuators, JointVector::Constant(1, 1.2));
    arm.apply(JointVector::Zero(1));
    double lost = 0;
    const double start = energy(arm);
    double power = 0;
    for (int i = 0; i < 80000; ++i) {
        arm.advance(1.25e-4);
        const double next = arm.state().friction[0] * arm.state().velocity[0];
        lost += (power + next) / 2 * 1.25e-4;
        power = next;
    }
    CHECK(energy(arm) - start == Approx(-lost).epsilon(1e-3));
    CHECK(std::abs(arm.state().velocity[0]) < 1e-6);
    // It rests where friction below the break-away level holds the weight.
    const double weight = 1 * 9.81 * 0.5 * std::sin(arm.state().position[0]);
    CHECK(std::abs(weight) > 1e-3);
    CHECK(std::abs(weight) < 0.8);
    CHECK(arm.state().friction[0] == Approx(-weight).epsilon(1e-3));
}

TEST_CASE("actuators do not exceed their torque limit") {
    ActuatorModel actuators = free_actuators(1);
    actuators.torque_limit = JointVector::Constant(1, 2);
    SimulatedArm arm(pendulum(1, 1), actuators, JointVector::Zero(1));
    arm.apply(JointVector::Constant(1, 100));
    CHECK(arm.state().torque[0] == 2);
    CHECK(arm.state().acceleration[0] == Approx(2));
    arm.apply(JointVector::Constant(1, -100));
    CHECK(arm.state().torque[0] == -2);
}

} // namespace simulated_arm_test
