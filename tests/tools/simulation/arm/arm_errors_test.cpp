// SPDX-License-Identifier: Apache-2.0
// Compares a simulated arm's deviations from its description with closed forms.
#include "tests/support/catch.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/base/text/error.hpp"
#include "tools/simulation/arm/simulated_arm.hpp"

#include <cmath>
#include <numbers>

namespace arm_errors_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// A pendulum of 0.25 kg·m² on a soft gear with a rotor of 0.05 kg·m², without gravity.
struct SoftJoint {
    static constexpr double link = 0.25, rotor = 0.05, stiffness = 400;

    static SimulatedArm arm(double gap, double twist_velocity) {
        Robot robot = pendulum(1, 0.5);
        robot.gravity.setZero();
        ActuatorModel actuators = free_actuators(1);
        actuators.rotor_inertia[0] = rotor;
        actuators.gear = {JointVector::Constant(1, stiffness), JointVector::Zero(1),
                          JointVector::Constant(1, gap)};
        SimulatedArm arm(robot, actuators, JointVector::Zero(1));
        // A short push on the rotor.
        constexpr double push_s = 1e-6;
        arm.apply(JointVector::Constant(1, rotor * twist_velocity / push_s));
        arm.advance(push_s);
        arm.apply(JointVector::Zero(1));
        return arm;
    }
    static double energy(const SimulatedArm& arm, double gap) {
        const SimulatedArm::State& state = arm.state();
        const double twist = std::abs(state.motor_position[0] - state.position[0]);
        const double pressed = std::max(0.0, twist - gap / 2);
        return 0.5 * (link * std::pow(state.velocity[0], 2) + rotor * std::pow(state.motor_velocity[0], 2) +
                      stiffness * pressed * pressed);
    }
};

TEST_CASE("rotor and link oscillate at the two-mass frequency and conserve energy and momentum") {
    SimulatedArm arm = SoftJoint::arm(0, 2);
    const double start = SoftJoint::energy(arm, 0);
    int crossings = 0;
    double past = 1;
    double first_s = 0;
    double last_s = 0;
    for (int step = 1; step <= 40000; ++step) {
        arm.advance(1e-4);
        const double twist = arm.state().motor_position[0] - arm.state().position[0];
        if (past < 0 && twist >= 0) {
            last_s = step * 1e-4 - 1e-4 * twist / (twist - past);
            first_s = crossings++ == 0 ? last_s : first_s;
        }
        past = twist;
    }
    const double omega = 2 * std::numbers::pi * (crossings - 1) / (last_s - first_s);
    const double expected = std::sqrt(SoftJoint::stiffness * (1 / SoftJoint::link + 1 / SoftJoint::rotor));
    CHECK(omega == Approx(expected).epsilon(1e-5));
    CHECK(SoftJoint::energy(arm, 0) == Approx(start).epsilon(1e-6));
    const double momentum =
        SoftJoint::rotor * arm.state().motor_velocity[0] + SoftJoint::link * arm.state().velocity[0];
    CHECK(momentum == Approx(SoftJoint::rotor * 2).epsilon(1e-6));
}

TEST_CASE("a rotor turns freely within its backlash and lossless contact returns all energy") {
    constexpr double gap = 0.1;
    SimulatedArm arm = SoftJoint::arm(gap, 1);
    const double start = SoftJoint::energy(arm, gap);
    for (int step = 0; step < 400; ++step) { // 0.04 rad, less than half the gap of 0.1
        arm.advance(1e-4);
    }
    CHECK(arm.state().motor_velocity[0] == Approx(1).epsilon(1e-9));
    CHECK(std::abs(arm.state().velocity[0]) < 1e-12);
    for (int step = 0; step < 20000; ++step) {
        arm.advance(1e-4);
        const double twist = arm.state().motor_position[0] - arm.state().position[0];
        REQUIRE(std::abs(twist) < gap / 2 + 2 * std::sqrt(SoftJoint::rotor / SoftJoint::stiffness));
    }
    CHECK(arm.state().velocity[0] != 0);
    CHECK(SoftJoint::energy(arm, gap) == Approx(start).epsilon(1e-4));
}

TEST_CASE("a gear with backlash pushes but never pulls") {
    const GearModel gear{JointVector::Constant(1, 100), JointVector::Constant(1, 10),
                         JointVector::Constant(1, 0.2)};
    CHECK(gear.torque(0, 0.1, 5) == 0);
    CHECK(gear.torque(0, 0.15, 0) == Approx(5));
    CHECK(gear.torque(0, -0.15, 0) == Approx(-5));
    CHECK(gear.torque(0, 0.15, -1) == 0); // separating parts do not stick
    GearModel tight = gear;
    tight.gap[0] = 0;
    CHECK(tight.torque(0, 0.1, -2) == Approx(-10));
}

TEST_CASE("a soft joint requires rotor inertia and must be revolute") {
    ActuatorModel actuators = free_actuators(1);
    actuators.gear = {JointVector::Constant(1, 100), JointVector::Zero(1), JointVector::Zero(1)};
    CHECK_THROWS_AS(SimulatedArm(pendulum(1, 1), actuators, JointVector::Zero(1)), InputError);
    actuators.rotor_inertia[0] = 0.1;
    Robot sliding = pendulum(1, 1);
    sliding.joints[0].prismatic = true;
    CHECK_THROWS_AS(SimulatedArm(sliding, actuators, JointVector::Zero(1)), InputError);
}

TEST_CASE("an arm with more rotors and links than a simulation holds is refused") {
    Robot robot = pendulum(1, 1);
    const RobotJoint joint = robot.joints.front();
    robot.joints.assign(7, joint);
    ActuatorModel actuators = free_actuators(7);
    actuators.rotor_inertia.setConstant(0.1);
    actuators.gear = {JointVector::Constant(7, 100), JointVector::Zero(7), JointVector::Zero(7)};
    CHECK_THROWS_WITH(SimulatedArm(robot, actuators, JointVector::Zero(7)),
                      "actuators: expected at most 12 joints, each soft one counted twice, found 14");
    actuators.gear.stiffness.head(2).setZero();
    CHECK(SimulatedArm(robot, actuators, JointVector::Zero(7)).dynamics().joint_count() == 12);
}

TEST_CASE("a load beyond a soft joint hangs at rest from the start") {
    ActuatorModel actuators = free_actuators(1);
    actuators.rotor_inertia[0] = 0.05;
    actuators.gear = {JointVector::Constant(1, 200), JointVector::Zero(1), JointVector::Constant(1, 0.01)};
    SimulatedArm arm(pendulum(1, 0.5), actuators, JointVector::Constant(1, 0.8));
    const double weight = 9.81 * 0.5 * std::sin(0.8);
    arm.apply(JointVector::Constant(1, weight));
    CHECK(arm.state().motor_position[0] == 0.8);
    CHECK(arm.state().position[0] == Approx(0.8 - weight / 200 - 0.005));
    CHECK(std::abs(arm.state().motor_acceleration[0]) < 1e-9);
}

TEST_CASE("a spring makes its joint oscillate and a push at the tip turns it by its lever") {
    Robot robot = pendulum(1, 0.5);
    robot.gravity.setZero();
    JointLoads spring;
    spring.springs = JointSprings{JointVector::Constant(1, 4), JointVector::Constant(1, 0.2)};
    SimulatedArm swinging(robot, free_actuators(1), JointVector::Constant(1, 0.5), spring);
    swinging.apply(JointVector::Zero(1));
    const double half_period = std::numbers::pi / std::sqrt(4 / 0.25);
    for (int step = 0; step < 1000; ++step) {
        swinging.advance(half_period / 1000);
    }
    CHECK(swinging.state().position[0] == Approx(-0.1).epsilon(1e-6));

    JointLoads push;
    Contact contact;
    contact.start_s = 0;
    contact.end_s = 2;
    contact.force = Eigen::Vector3d(0, 3, 0);
    push.contacts = {contact};
    SimulatedArm pushed(robot, free_actuators(1), JointVector::Zero(1), push);
    // The integral of the pulse's torque over a quarter of a second, nearly at rest. A force along +y at z =
    // -0.5 turns the joint about +x.
    for (int step = 0; step < 2500; ++step) {
        pushed.advance(1e-4);
    }
    const double impulse = 3 * 0.5 * (0.25 / 2 - std::sin(std::numbers::pi * 0.25) / (2 * std::numbers::pi));
    CHECK(pushed.state().velocity[0] == Approx(impulse / 0.25).epsilon(1e-3));
}

TEST_CASE("an actuator of limited bandwidth approaches its command exponentially from the first command on") {
    ActuatorModel actuators = free_actuators(1);
    actuators.bandwidth_hz = 20;
    SimulatedArm arm(pendulum(1, 0.5), actuators, JointVector::Zero(1));
    arm.apply(JointVector::Constant(1, 1));
    CHECK(arm.state().torque[0] == 1);
    arm.apply(JointVector::Constant(1, 3));
    arm.advance(5e-3);
    CHECK(arm.state().torque[0] == Approx(3 - 2 * std::exp(-2 * std::numbers::pi * 20 * 5e-3)));
}

} // namespace arm_errors_test
