// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulation.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/simulation/simulation_csv.hpp"

#include <cmath>
#include <sstream>

namespace simulation_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

const std::string data = DFDYN_TEST_DATA_DIR;

Robot read(const std::string& scenario, const std::string& robot) {
    const ScenarioChain chain = read_scenario_chain(data + "/scenarios/" + scenario);
    ReadRobotOptions options;
    options.tip = chain.tip;
    Robot result = read_robot(data + "/robots/" + robot, options);
    result.tip_placement.translate(chain.tip_point);
    return result;
}

std::string bytes(const Robot& robot, const Scenario& scenario) {
    Simulation simulation(robot, scenario);
    std::ostringstream recording;
    std::ostringstream truth;
    SimulatedRecordingCsv recording_csv(recording, scenario, robot.joints.size());
    SimulatedTruthCsv truth_csv(truth, scenario.force_torque.has_value(), robot.joints.size());
    for (std::size_t i = 0; i < scenario.recording.samples; ++i) {
        const SimulatedSample sample = simulation.next();
        recording_csv.write(sample);
        truth_csv.write(sample.truth);
    }
    return recording.str() + truth.str();
}

TEST_CASE("a recording has the scenario's rate and jitter and the truth has no stamp error") {
    Scenario scenario = quiet_scenario(1);
    scenario.recording.rate_hz = 100;
    scenario.recording.first_at_s = 0.5;
    scenario.recording.instant_jitter_s = 4e-4;
    scenario.recording.stamp_jitter_s = 2e-4;
    Simulation simulation(pendulum(1, 0.5), scenario);
    double instants = 0;
    double stamps = 0;
    constexpr int samples = 3000;
    double past = 0;
    for (int i = 0; i < samples; ++i) {
        const SimulatedSample sample = simulation.next();
        REQUIRE(sample.time_s > past);
        past = sample.time_s;
        instants += std::pow(sample.truth.time_s - (0.5 + 0.01 * i), 2) / samples;
        stamps += std::pow(sample.time_s - sample.truth.time_s, 2) / samples;
    }
    // Sample times are whole steps of the integration.
    CHECK(std::sqrt(instants) == Approx(std::hypot(4e-4, 1.25e-4 / std::sqrt(12))).epsilon(0.04));
    CHECK(std::sqrt(stamps) == Approx(2e-4).epsilon(0.04));
}

TEST_CASE("the times of a recording increase even if jitter and integration step are near its period") {
    Scenario scenario = quiet_scenario(1);
    scenario.integration_rate_hz = 1000;
    scenario.recording.rate_hz = 900;
    scenario.recording.instant_jitter_s = 5e-5;
    scenario.recording.stamp_jitter_s = 5e-5;
    Simulation simulation(pendulum(1, 0.5), scenario);
    constexpr int samples = 6000;
    double past = -1;
    double true_past_s = -1;
    for (int i = 0; i < samples; ++i) {
        const SimulatedSample sample = simulation.next();
        REQUIRE(sample.time_s > past);
        REQUIRE(sample.truth.time_s > true_past_s);
        past = sample.time_s;
        true_past_s = sample.truth.time_s;
    }
    CHECK(past == Approx((samples - 1) / 900.0).margin(1.5e-3)); // the rate is kept
}

TEST_CASE("perfect sensors measure the true values and the torque is inverse dynamics plus friction") {
    Scenario scenario = quiet_scenario(1);
    scenario.actuators.friction[0] = {500, 1, 0.2, 0.4, 0.6, 0.05};
    scenario.actuators.rotor_inertia[0] = 0.05;
    scenario.recording.samples = 400;
    Simulation simulation(pendulum(1, 0.5), scenario);
    for (int i = 0; i < 400; ++i) {
        const SimulatedSample sample = simulation.next();
        const SimulatedTruth& truth = sample.truth;
        REQUIRE(sample.torque[0] == truth.torque[0]);
        REQUIRE(std::abs(sample.position[0] - truth.position[0]) < 2e-3); // readings are held for up to 1 ms
        const double inertia = 0.25 + 0.05;
        const double expected =
            inertia * truth.acceleration[0] + 9.81 * 0.5 * std::sin(truth.position[0]) + truth.friction[0];
        REQUIRE(truth.torque[0] == Approx(expected).margin(1e-9));
    }
}

TEST_CASE("derivatives estimated at a lower rate have more lag and do not change the motion") {
    Scenario scenario = quiet_scenario(1);
    scenario.recording.first_at_s = 2;
    scenario.recording.rate_hz = 50;
    scenario.recording.samples = 200;
    Scenario slow = scenario;
    slow.derivatives.rate_hz = scenario.encoders.rate_hz / 20;
    Simulation fast_simulation(pendulum(1, 0.5), scenario);
    Simulation slow_simulation(pendulum(1, 0.5), slow);
    double fast_error = 0;
    double slow_error = 0;
    for (std::size_t i = 0; i < scenario.recording.samples; ++i) {
        const SimulatedSample with_fast = fast_simulation.next();
        const SimulatedSample with_slow = slow_simulation.next();
        REQUIRE(with_fast.truth.position[0] == with_slow.truth.position[0]);
        fast_error += std::abs(with_fast.velocity[0] - with_fast.truth.velocity[0]);
        slow_error += std::abs(with_slow.velocity[0] - with_slow.truth.velocity[0]);
    }
    CHECK(slow_error > 3 * fast_error);
}

TEST_CASE("the true acceleration is the derivative of the true velocity within a controller step") {
    Scenario scenario = quiet_scenario(1);
    scenario.recording.rate_hz = 4000; // every second integration step
    scenario.recording.first_at_s = 2;
    Simulation simulation(pendulum(1, 0.5), scenario);
    SimulatedTruth first = simulation.next().truth;
    for (int i = 0; i < 400; ++i) {
        const SimulatedTruth second = simulation.next().truth;
        // The torque is constant over the step and the acceleration nearly constant.
        const double slope = (second.velocity[0] - first.velocity[0]) / (second.time_s - first.time_s);
        REQUIRE(slope == Approx(first.acceleration[0]).margin(0.05));
        first = second;
    }
}

TEST_CASE("the iCub's tip moves around its circle of 10 cm in both planes with small variations") {
    for (const std::string name : {"icub_xy.json", "icub_xz.json"}) {
        CAPTURE(name);
        const Robot robot = read(name, "icub_right_arm/icub_right_arm.urdf");
        const Scenario scenario = read_scenario(data + "/scenarios/" + name, robot);
        const auto& circle = std::get<CircleTask>(scenario.task);
        CHECK(circle.radius == 0.1);
        CHECK(circle.period_s == 1.25);
        CHECK(scenario.recording.samples == 10000);
        CHECK(scenario.recording.rate_hz == 20);
        Simulation simulation(robot, scenario);
        double radius = 0;
        double turned = 0;
        double past = 0;
        constexpr int samples = 300; // 15 s, which are 12 turns
        for (int i = 0; i < samples; ++i) {
            const SimulatedTruth truth = simulation.next().truth;
            const Eigen::Vector3d from_centre = truth.tip - circle.centre;
            const double x = from_centre[circle.first_axis];
            const double y = from_centre[circle.second_axis];
            const double off_plane = (from_centre - x * Eigen::Vector3d::Unit(circle.first_axis) -
                                      y * Eigen::Vector3d::Unit(circle.second_axis))
                                         .norm();
            REQUIRE(off_plane < 0.02);
            REQUIRE(std::abs(std::hypot(x, y) - 0.1) < 0.03);
            radius += std::hypot(x, y) / samples;
            const double angle = std::atan2(y, x);
            turned += i > 0 ? std::remainder(angle - past, 2 * std::acos(-1)) : 0;
            past = angle;
        }
        CHECK(radius == Approx(0.1).margin(0.006));
        CHECK(turned / (2 * std::acos(-1)) == Approx(12).epsilon(0.1));
    }
}

TEST_CASE("robot and scenario and seed determine every byte and another seed changes them") {
    const Robot robot = read("icub_xy.json", "icub_right_arm/icub_right_arm.urdf");
    Scenario scenario = read_scenario(data + "/scenarios/icub_xy.json", robot);
    scenario.recording.samples = 30;
    scenario.recording.columns = {"q", "qd", "qdd", "tau", "wrench"};
    const std::string first = bytes(robot, scenario);
    CHECK(first == bytes(robot, scenario));
    scenario.seed += 1;
    CHECK(first != bytes(robot, scenario));
}

TEST_CASE("the shipped joint-space example runs and its recording has the columns of the scenario") {
    const Robot robot = read("ur5_multisine.json", "ur5/ur5_robot.urdf");
    Scenario scenario = read_scenario(data + "/scenarios/ur5_multisine.json", robot);
    scenario.recording.samples = 50;
    const std::string text = bytes(robot, scenario);
    CHECK_THAT(text, Catch::Matchers::StartsWith(
                         "t,q1,q2,q3,q4,q5,q6,qd1,qd2,qd3,qd4,qd5,qd6,tau1,tau2,tau3,tau4,tau5,tau6,"
                         "i1,i2,i3,i4,i5,i6\n"));
}

TEST_CASE("a reference beyond a joint limit and an unstable arm are reported with their time") {
    Robot robot = pendulum(1, 0.5);
    robot.joints[0].upper = 0.31;
    Simulation limited(robot, quiet_scenario(1));
    CHECK_THROWS_WITH(
        [&] {
            for (int i = 0; i < 1000; ++i) {
                limited.next();
            }
        }(),
        Catch::Matchers::StartsWith("t = ") &&
            Catch::Matchers::ContainsSubstring("s: reference of joint swing: expected a position within its "
                                               "limits, found ") &&
            Catch::Matchers::ContainsSubstring("beyond its upper limit 0.31 rad"));

    Scenario wild = quiet_scenario(1);
    wild.controller.velocity_gain *= -1;
    Simulation unstable(pendulum(1, 0.5), wild);
    CHECK_THROWS_WITH(
        [&] {
            for (int i = 0; i < 1000; ++i) {
                unstable.next();
            }
        }(),
        Catch::Matchers::ContainsSubstring("found a diverging one"));
}

} // namespace simulation_test
