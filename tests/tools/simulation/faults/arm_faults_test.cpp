// SPDX-License-Identifier: Apache-2.0
// Compares the effect of faults of an arm and of its actuators with mechanics.
#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/simulation/simulated_plant.hpp"
#include "tools/simulation/simulation.hpp"

#include <cmath>

namespace arm_faults_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

constexpr double mass = 2, length = 0.5, gravity = 9.81, inertia = mass * length * length;

/// The pendulum at rest at `position`, with the faults of a scenario.
SimulatedPlant plant_with(const std::string& faults, double position, Scenario scenario = quiet_scenario(1)) {
    scenario.faults = faults_of(faults, 1);
    return {pendulum(mass, length), scenario, JointVector::Constant(1, position)};
}

double acceleration(const SimulatedPlant& plant) { return plant.truth().acceleration[0]; }

Robot weightless(Robot robot) {
    robot.gravity.setZero();
    return robot;
}

TEST_CASE("doubled friction requires twice the torque at the same speed while the fault acts") {
    Scenario scenario = quiet_scenario(1);
    scenario.actuators.friction[0] = {2000, 0, 2, 1, 1, 0.1};
    scenario.faults = faults_of(R"([{"kind": "friction_step", "factor": 2, "from_s": 4, "for_s": 4}])", 1);
    SimulatedPlant plant(weightless(pendulum(mass, length)), scenario, JointVector::Zero(1));
    plant.apply(JointVector::Constant(1, 3));
    const auto settled = [](double torque, double factor) { return (torque / factor - 1) / 2; };
    plant.advance_to(3.999);
    CHECK(plant.truth().velocity[0] == Approx(settled(3, 1)).epsilon(1e-3));
    CHECK(plant.truth().friction[0] == Approx(3).epsilon(1e-3));
    plant.advance_to(7.999);
    CHECK(plant.truth().velocity[0] == Approx(settled(3, 2)).epsilon(1e-3));
    plant.advance_to(12);
    CHECK(plant.truth().velocity[0] == Approx(settled(3, 1)).epsilon(1e-3));
}

TEST_CASE("a constant push accelerates the pendulum by lever times force from its start to its end") {
    const double angle = 0.7;
    // The force is in the frame of the base, the lever in the frame of the link.
    const Eigen::Vector3d force(5, 3, -2), lever(0.1, 0.05, -0.3);
    SimulatedPlant plant = plant_with(R"([{"kind": "push", "force_n": [5, 3, -2], "link": 1,
        "point_m": [0.1, 0.05, -0.3], "from_s": 0.1, "for_s": 0.2}])",
                                      angle);
    plant.apply(JointVector::Constant(1, mass * gravity * length * std::sin(angle))); // balances the weight
    plant.advance_to(0.099);
    CHECK(acceleration(plant) == Approx(0).margin(1e-12));
    plant.advance_to(0.1);
    const auto expected = [&](double share) {
        const double now = plant.truth().position[0];
        const Eigen::Vector3d arm = Eigen::AngleAxisd(now, Eigen::Vector3d::UnitX()) * lever;
        return gravity / length * (std::sin(angle) - std::sin(now)) + share * arm.cross(force).x() / inertia;
    };
    CHECK(acceleration(plant) == Approx(expected(1)).epsilon(1e-9));
    plant.advance_to(0.2999);
    CHECK(acceleration(plant) == Approx(expected(1)).epsilon(1e-9));
    plant.advance_to(0.3);
    CHECK(acceleration(plant) == Approx(expected(0)).epsilon(1e-9));
}

TEST_CASE("an external torque at the joint and a force at the tip are equivalent") {
    SimulatedPlant by_torque = plant_with(R"([{"kind": "push", "joint": 1, "torque_nm": 1.5}])", 0);
    SimulatedPlant by_force = plant_with(R"([{"kind": "push", "force_n": [0, 3, 0]}])", 0); // lever: 0.5 m
    CHECK(acceleration(by_torque) == Approx(1.5 / inertia));
    CHECK(acceleration(by_force) == Approx(1.5 / inertia));
}

// The torque of a push on joint i is the force times the motion of its point when that joint turns.
TEST_CASE("a push on a link of a random arm does its virtual work and loads no joint beyond the link") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = random_robot(engine, 5);
    JointVector position(5);
    for (double& angle : position) {
        angle = uniform(engine, -2, 2);
    }
    ArmFaults faults(5);
    const Eigen::Vector3d point(0.1, -0.2, 0.3), force(4, -5, 6);
    faults.pushes.push_back({2, point, force});
    SimulatedArm arm(robot, free_actuators(5), position);
    const JointVector before = arm.state().acceleration;
    const JointMatrix mass_matrix = arm.dynamics().mass_matrix(arm.configuration());
    arm.set_faults(faults);
    const JointVector torque = mass_matrix * (arm.state().acceleration - before);
    const auto place = [&](const JointVector& at) {
        ArmDynamics::Configuration configuration;
        arm.dynamics().configure(at, configuration);
        return Eigen::Vector3d(configuration.place[2] * point);
    };
    for (Eigen::Index i = 0; i < 5; ++i) {
        constexpr double step = 1e-6;
        JointVector forth = position, back = position;
        forth[i] += step;
        back[i] -= step;
        CHECK(torque[i] == Approx(force.dot(place(forth) - place(back)) / (2 * step)).margin(1e-6));
    }
}

TEST_CASE("a force/torque sensor measures only pushes on the parts beyond it") {
    Robot robot = pendulum(mass, length);
    robot.sensor.emplace();
    robot.sensor->link = 1;
    robot.sensor->parent_to_child = true;
    robot.sensor->inertia_beyond = robot.joints[0].inertia;
    const auto felt = [&](const std::string& place) {
        SimulatedArm arm(robot, free_actuators(1), JointVector::Zero(1));
        Faults faults(1);
        faults_of(R"([{"kind": "push", )" + place + R"("force_n": [0, 0, 19.62]}])", 1)[0].act(faults);
        arm.set_faults(faults.arm); // balances the whole weight
        return arm.wrench();
    };
    CHECK(felt("").norm() < 1e-9);
    CHECK(felt(R"("link": 1, "point_m": [0, 0, -0.5], )")[2] == Approx(mass * gravity));
}

TEST_CASE("an actuator's gain and limit apply to its command even if that came earlier") {
    Scenario scenario = quiet_scenario(1);
    scenario.actuators.torque_limit = JointVector::Constant(1, 10);
    const auto torque_at = [&](const std::string& fault, double command, double time_s) {
        SimulatedPlant plant = plant_with("[" + fault + "]", 0, scenario);
        plant.apply(JointVector::Constant(1, command));
        plant.advance_to(time_s);
        const double weight = mass * gravity * length * std::sin(plant.truth().position[0]);
        CHECK(inertia * acceleration(plant) + weight == Approx(plant.truth().torque[0]));
        return plant.truth().torque[0];
    };
    const std::string gain =
        R"({"kind": "actuator_gain", "joint": 1, "factor": 0.6, "from_s": 0.1, "for_s": 0.1})";
    CHECK(torque_at(gain, 5, 0.099) == 5);
    CHECK(torque_at(gain, 5, 0.1) == 3);
    CHECK(torque_at(gain, 20, 0.1) == 6); // to a command that its drive limits
    CHECK(torque_at(gain, 5, 0.2) == 5);
    const std::string limit =
        R"({"kind": "actuator_saturation", "joint": [1], "limit_nm": 4, "from_s": 0.1})";
    CHECK(torque_at(limit, 5, 0.099) == 5);
    CHECK(torque_at(limit, 5, 0.1) == 4);
    CHECK(torque_at(limit, -5, 0.1) == -4);
    CHECK(torque_at(limit, 3, 0.1) == 3);
    CHECK(torque_at(gain + "," + limit, 9, 0.1) == 4); // 5.4 N·m without the limit
}

TEST_CASE("a fault changes no bit before it begins and a fault without effect changes none at all") {
    Scenario scenario = quiet_scenario(1);
    scenario.encoders.noise = 1e-3;
    scenario.torque_sensor.noise = JointVector::Constant(1, 0.1);
    scenario.actuators.friction[0] = {2000, 0, 0.5, 1, 1, 0.1, 0, 0.1}; // its load increases the friction
    const auto rows = [&](const std::string& faults) {
        scenario.faults = faults_of(faults, 1);
        Simulation simulation(pendulum(mass, length), scenario);
        std::vector<double> values;
        for (int row = 0; row < 100; ++row) {
            const SimulatedSample sample = simulation.next();
            values.insert(values.end(), {sample.truth.position[0], sample.position[0], sample.torque[0]});
        }
        return values;
    };
    const std::vector<double> without = rows("[]");
    CHECK(rows(R"([{"kind": "push", "joint": 1, "torque_nm": 9, "from_s": 5}])") == without);
    CHECK(rows(R"([{"kind": "friction_step", "factor": 1}, {"kind": "actuator_gain", "factor": 1},
                   {"kind": "actuator_saturation", "limit_nm": 1e5}, {"kind": "torque_scale", "factor": 1},
                   {"kind": "torque_bias", "nm": 0}, {"kind": "encoder_jump", "joint": 1, "rad": 0, "at_s": 0},
                   {"kind": "push", "force_n": [0, 0, 0]}])") == without);
    for (const char* const kind : {R"("friction_step", "factor": 3)", R"("actuator_gain", "factor": 0.5)",
                                   R"("torque_scale", "factor": 2)", R"("torque_bias", "nm": 1)",
                                   R"("actuator_saturation", "limit_nm": 0.1)",
                                   R"("push", "force_n": [0, 5, 0])", R"("encoder_frozen", "joint": 1)"}) {
        CHECK(rows(std::string(R"([{"kind": )") + kind + ", \"from_s\": 0.5}]") != without);
    }
}

} // namespace arm_faults_test
