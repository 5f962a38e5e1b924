// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include <cmath>

namespace arm_dynamics_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

JointVector random_joints(std::mt19937_64& engine, int n) {
    return JointVector::NullaryExpr(n, [&] { return uniform(engine, -2, 2); });
}

TEST_CASE("forward dynamics invert inverse dynamics and the mass matrix is its linear part") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 100; ++trial) {
        const int n = 1 + trial % 7;
        const JointVector rotors = random_joints(engine, n).cwiseAbs();
        const ArmDynamics arm(random_robot(engine, n), rotors);
        const JointVector velocity = random_joints(engine, n);
        const JointVector acceleration = random_joints(engine, n);
        ArmDynamics::Configuration configuration;
        arm.configure(random_joints(engine, n), configuration);
        const JointVector torque = arm.inverse(configuration, velocity, acceleration);
        CAPTURE(trial, n);
        const JointVector error = arm.forward(configuration, velocity, torque) - acceleration;
        CHECK(error.norm() < 1e-9 * (1 + acceleration.norm()));
        const JointVector bias = arm.inverse(configuration, velocity, JointVector::Zero(n));
        const JointVector linear = torque - bias - arm.mass_matrix(configuration) * acceleration;
        CHECK(linear.norm() < 1e-10 * torque.norm());
    }
}

TEST_CASE("torque and energy of a pendulum are those of the textbook") {
    const double mass = 2;
    const double length = 0.7;
    const double rotor = 0.3;
    const ArmDynamics arm(pendulum(mass, length), JointVector::Constant(1, rotor));
    ArmDynamics::Configuration configuration;
    const JointVector one = JointVector::Constant(1, 1);
    for (const double q : {-2.0, 0.0, 0.4, 1.5}) {
        CAPTURE(q);
        arm.configure(q * one, configuration);
        const double inertia = mass * length * length + rotor;
        CHECK(arm.inverse(configuration, 3 * one, 5 * one)[0] ==
              Approx(inertia * 5 + mass * 9.81 * length * std::sin(q)));
        CHECK(arm.energy(configuration, 3 * one) ==
              Approx(0.5 * inertia * 9 - mass * 9.81 * length * std::cos(q)));
        CHECK(arm.tip(configuration).z() == Approx(-length * std::cos(q)));
    }
}

TEST_CASE("the tip's Jacobian is the derivative of the tip") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 30; ++trial) {
        const int n = 1 + trial % 6;
        Robot robot = random_robot(engine, n);
        robot.tip_placement = random_placement(engine);
        const ArmDynamics arm(robot, JointVector::Zero(n));
        const JointVector q = random_joints(engine, n);
        const JointVector direction = random_joints(engine, n);
        ArmDynamics::Configuration configuration;
        arm.configure(q + 1e-6 * direction, configuration);
        const Eigen::Vector3d ahead = arm.tip(configuration);
        arm.configure(q - 1e-6 * direction, configuration);
        const Eigen::Vector3d difference = (ahead - arm.tip(configuration)) / 2e-6;
        arm.configure(q, configuration);
        CHECK((arm.tip_jacobian(configuration) * direction - difference).norm() < 1e-7);
    }
}

TEST_CASE("the iCub's arm at rest loads its sensor with the weight of 1.93 kg in any posture") {
    ReadRobotOptions options;
    options.tip = "r_hand";
    Robot robot = read_robot(DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf", options);
    REQUIRE(robot.sensor);
    const JointVector still = JointVector::Zero(4);
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 20; ++trial) {
        const JointVector q = random_joints(engine, 4);
        const ArmDynamics arm(robot, still);
        ArmDynamics::Configuration configuration;
        arm.configure(q, configuration);
        const Wrench wrench = arm.wrench(configuration, still, still);
        CHECK(wrench.head<3>().norm() == Approx(1.9323 * 9.81).epsilon(1e-3));
        // The child pulls the parent down, and child to parent is the direction of this robot's sensor.
        const Eigen::Isometry3d frame = configuration.place[2] * robot.sensor->placement;
        CHECK((frame.linear() * wrench.head<3>()).z() == Approx(-wrench.head<3>().norm()));

        Robot reversed = robot;
        reversed.sensor->parent_to_child = true;
        CHECK((ArmDynamics(reversed, still).wrench(configuration, still, still) + wrench).norm() == 0);
    }
}

TEST_CASE("chains too long for the simulation and negative masses are rejected") {
    CHECK_THROWS_AS(ArmDynamics(Robot(), JointVector()), InputError);
    Robot robot = pendulum(1, 1);
    robot.joints.resize(13, robot.joints[0]);
    CHECK_THROWS_WITH(ArmDynamics(robot, JointVector()),
                      "robot pendulum: expected a chain of 1 to 12 joints, found 13");
    robot = pendulum(1, 1);
    robot.joints[0].inertia[0] = -1;
    CHECK_THROWS_WITH(ArmDynamics(robot, JointVector::Zero(1)),
                      Catch::Matchers::ContainsSubstring("link rod: expected a mass"));
}

} // namespace arm_dynamics_test
