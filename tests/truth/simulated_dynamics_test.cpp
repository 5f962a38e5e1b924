// SPDX-License-Identifier: Apache-2.0
// Compares the rigid-body dynamics of the simulation with DART on random chains of revolute and prismatic
// joints.
#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/truth/dart_wrench.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

using tools::JointVector;

tools::Robot random_robot_with_sensor(std::mt19937_64& engine, int n) {
    tools::Robot robot = random_robot(engine, n);
    robot.sensor.emplace();
    robot.sensor->link = std::uniform_int_distribution<std::size_t>(0, static_cast<std::size_t>(n))(engine);
    robot.sensor->placement = random_placement(engine);
    if (robot.sensor->link > 0) { // DART's chain does not include a part of the base beyond the sensor
        robot.sensor->inertia_beyond = random_body(engine).parameters();
    }
    return robot;
}

JointVector every_third(const Eigen::VectorXd& xi, Eigen::Index first) {
    return xi(Eigen::seqN(first, xi.size() / 3, 3));
}

} // namespace

TEST_CASE("the simulated wrench at a sensor on any link or on the base equals DART's") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 300; ++trial) {
        const int n = 1 + trial % 7;
        tools::Robot robot = random_robot_with_sensor(engine, n);
        const Eigen::VectorXd xi = random_motion(engine, n);
        const tools::ArmDynamics arm(robot, JointVector::Zero(n));
        tools::ArmDynamics::Configuration configuration;
        arm.configure(every_third(xi, 0), configuration);
        const Wrench found = arm.wrench(configuration, every_third(xi, 1), every_third(xi, 2));
        const Wrench expected = -dart_wrench(robot, xi); // child to parent
        CAPTURE(trial, n, robot.sensor->link);
        REQUIRE((found - expected).norm() < 1e-9 * expected.norm());
    }
}

TEST_CASE("the forward dynamics of the simulation equal DART's") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 300; ++trial) {
        const int n = 1 + trial % 7;
        const tools::Robot robot = random_robot_with_sensor(engine, n);
        tools::Robot whole = robot; // DART's skeleton has the part beyond the sensor as a separate body
        if (robot.sensor->link > 0) {
            whole.joints[robot.sensor->link - 1].inertia += robot.sensor->inertia_beyond;
        }
        const Eigen::VectorXd xi = random_motion(engine, n);
        const JointVector position = every_third(xi, 0);
        const JointVector velocity = every_third(xi, 1);
        const JointVector torque = 10 * every_third(xi, 2);
        const tools::ArmDynamics arm(whole, JointVector::Zero(n));
        tools::ArmDynamics::Configuration configuration;
        arm.configure(position, configuration);
        const Eigen::VectorXd expected = dart_acceleration(robot, position, velocity, torque);
        const Eigen::VectorXd error =
            Eigen::VectorXd(arm.forward(configuration, velocity, torque)) - expected;
        CAPTURE(trial, n);
        REQUIRE(error.norm() < 1e-9 * expected.norm());
    }
}
