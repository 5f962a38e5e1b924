// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/scenario/payload_schedule.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <cmath>

namespace payload_schedule_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

constexpr double mass = 2, length = 0.5, gravity = 9.81;

/// Acceleration of the pendulum at rest at 0.3 rad without torque.
double acceleration_of(const SimulatedArm& arm) { return arm.state().acceleration[0]; }

SimulatedArm resting() { return {pendulum(mass, length), free_actuators(1), JointVector::Constant(1, 0.3)}; }

TEST_CASE("a payload is attached to the last link as one body once at its time") {
    SimulatedArm arm = resting();
    const double alone = -gravity / length * std::sin(0.3);
    REQUIRE(acceleration_of(arm) == Approx(alone));
    // At half the length from the joint, which is half the length back from the tip in its frame.
    PayloadSchedule schedule({{1.5, 3, {0, 0, length / 2}}}, pendulum(mass, length));
    schedule.update(1.499, arm);
    CHECK(acceleration_of(arm) == Approx(alone));
    const double moment = mass * length + 3 * length / 2;
    const double inertia = mass * length * length + 3 * length * length / 4;
    for (int again = 0; again < 2; ++again) {
        schedule.update(1.5 + again, arm);
        CHECK(acceleration_of(arm) == Approx(-gravity * moment / inertia * std::sin(0.3)));
    }
}

TEST_CASE("payloads that are due together are all attached without a jump of the motion") {
    SimulatedArm arm = resting();
    arm.advance(0.1);
    const double position = arm.state().position[0], velocity = arm.state().velocity[0];
    PayloadSchedule schedule({{0, 1, {0, 0, 0}}, {0.1, 1, {0, 0, length}}, {5, 1, {0, 0, 0}}},
                             pendulum(mass, length));
    schedule.update(0.1, arm);
    CHECK(arm.state().position[0] == position);
    CHECK(arm.state().velocity[0] == velocity);
    // The second payload is on the axis, where a point mass does not affect the motion.
    CHECK(acceleration_of(arm) == Approx(-gravity / length * std::sin(position)));
    arm.apply(JointVector::Constant(1, 1));
    const double swing = -gravity / length * std::sin(position);
    CHECK(acceleration_of(arm) == Approx(swing + 1 / ((mass + 1) * length * length)));
}

TEST_CASE("removing a payload restores the arm with its other payloads") {
    SimulatedArm arm = resting();
    PayloadSchedule schedule({{0, 1, {0, 0, 0}, 2}, {1, 3, {0, 0, length / 2}}, {1.5, 5, {0.1, 0, 0}, 2}},
                             pendulum(mass, length));
    schedule.update(0.5, arm);
    CHECK(acceleration_of(arm) == Approx(-gravity / length * std::sin(0.3)));
    schedule.update(1.999, arm);
    schedule.update(2, arm);
    const double moment = mass * length + 3 * length / 2;
    const double inertia = mass * length * length + 3 * length * length / 4;
    CHECK(acceleration_of(arm) == Approx(-gravity * moment / inertia * std::sin(0.3)));
    PayloadSchedule alone({{0, 0.1, {0, 0, 0.1}, 1}}, pendulum(mass, length));
    SimulatedArm other = resting();
    const double before = acceleration_of(other);
    alone.update(0, other);
    CHECK(acceleration_of(other) != before);
    alone.update(1, other);
    CHECK(acceleration_of(other) == before); // bit for bit
}

TEST_CASE("a plant attaches its payloads at their times") {
    Scenario scenario = quiet_scenario(1);
    scenario.payloads = {{0.25, 3, {0, 0, length / 2}}};
    const JointVector hanging = JointVector::Zero(1);
    SimulatedPlant plant(pendulum(mass, length), scenario, hanging);
    plant.apply(JointVector::Constant(1, 0.01));
    const auto expected = [&plant](double moment, double inertia) {
        return (0.01 - gravity * moment * std::sin(plant.truth().position[0])) / inertia;
    };
    plant.advance_to(0.249);
    CHECK(plant.truth().acceleration[0] == Approx(expected(mass * length, mass * length * length)));
    plant.advance_to(0.25);
    const double inertia = mass * length * length + 3 * length * length / 4;
    CHECK(plant.truth().acceleration[0] == Approx(expected(mass * length + 3 * length / 2, inertia)));
}

} // namespace payload_schedule_test
