// SPDX-License-Identifier: Apache-2.0
// Compares the regressor of the wrench at a sensor with DART, in which the sensor is a weld between two
// bodies.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/truth/dart_wrench.hpp"
#include "tests/truth/regressor.hpp"

namespace {

using namespace dfdyn;
using namespace dfdyn::tests;

using Arm = Chain<dynamic, WrenchAtSensor<dynamic>>;

tools::Robot random_robot_with_sensor(std::mt19937_64& engine, int n, std::size_t link) {
    tools::Robot robot = random_robot(engine, n);
    robot.sensor.emplace();
    robot.sensor->link = link;
    robot.sensor->placement = random_placement(engine);
    robot.sensor->inertia_beyond = random_body(engine).parameters();
    return robot;
}

/// Parameters of the bodies beyond the sensor.
Eigen::VectorXd parameters_beyond(const tools::Robot& robot, int bodies) {
    Eigen::VectorXd parameters(inertial_parameters * bodies);
    for (int body = 0; body < bodies; ++body) {
        const std::size_t link = robot.joints.size() - static_cast<std::size_t>(bodies - body) + 1;
        parameters.segment<inertial_parameters>(inertial_parameters * body) =
            link == robot.sensor->link ? robot.sensor->inertia_beyond : robot.joints[link - 1].inertia;
    }
    return parameters;
}

Eigen::VectorXd wrench(const tools::Robot& robot, double sign, const Eigen::VectorXd& xi) {
    const int n = static_cast<int>(robot.joints.size());
    const int link = static_cast<int>(robot.sensor->link);
    const int bodies = link == 0 ? n : n - link + 1;
    Arm::Constants<double> chain = chain_of<Arm>(robot);
    chain.output = {link, placement_of(robot.sensor->placement), sign};
    return regressor<Arm>(chain, {{n}, {}, {bodies}}, xi) * parameters_beyond(robot, bodies);
}

} // namespace

TEST_CASE("the wrench at a sensor on any link or on the base equals DART's in both directions") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 500; ++trial) {
        const int n = 1 + trial % 7;
        const std::size_t link =
            std::uniform_int_distribution<std::size_t>(0, static_cast<std::size_t>(n))(engine);
        const tools::Robot robot = random_robot_with_sensor(engine, n, link);
        const Eigen::VectorXd xi = random_motion(engine, n);
        const Wrench expected = dart_wrench(robot, xi);
        CAPTURE(trial, n, link);
        REQUIRE((wrench(robot, 1, xi) - expected).norm() < 1e-9 * expected.norm());
        REQUIRE((wrench(robot, -1, xi) + expected).norm() < 1e-9 * expected.norm());
    }
}
