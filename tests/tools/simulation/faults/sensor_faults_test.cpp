// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/simulation/simulated_plant.hpp"

#include <cmath>

namespace sensor_faults_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// A pendulum that falls from 1 rad without torque, with perfect encoders of 1 kHz.
SimulatedPlant falling(const std::string& faults, Scenario scenario = quiet_scenario(1)) {
    scenario.faults = faults_of(faults, 1);
    SimulatedPlant plant(pendulum(1, 0.5), scenario, JointVector::Constant(1, 1));
    plant.apply(JointVector::Zero(1));
    return plant;
}

TEST_CASE("a frozen encoder repeats its last reading until the fault ends") {
    SimulatedPlant plant =
        falling(R"([{"kind": "encoder_frozen", "joint": 1, "from_s": 0.2, "for_s": 0.1}])");
    plant.advance_to(0.199);
    const double last = plant.truth().position[0];
    CHECK(plant.position()[0] == last);
    for (const double time_s : {0.2, 0.25, 0.299}) {
        plant.advance_to(time_s);
        CHECK(plant.position()[0] == last);
        CHECK(std::abs(plant.truth().position[0] - last) > 1e-3);
    }
    plant.advance_to(0.3);
    CHECK(plant.position()[0] == plant.truth().position[0]);
}

TEST_CASE("an encoder that is frozen from the start shows the initial position") {
    SimulatedPlant plant = falling(R"([{"kind": "encoder_frozen", "joint": 1}])");
    plant.advance_to(0.5);
    CHECK(plant.position()[0] == 1);
}

TEST_CASE("a jump of an encoder changes its readings permanently or for a time but not the motion") {
    SimulatedPlant plant = falling(R"([{"kind": "encoder_jump", "joint": 1, "rad": 0.05, "at_s": 0.1},
        {"kind": "encoder_jump", "joint": 1, "rad": -0.2, "at_s": 0.2, "for_s": 0.001}])");
    SimulatedPlant sound = falling("[]");
    const auto difference = [&](double time_s) {
        plant.advance_to(time_s);
        sound.advance_to(time_s);
        CHECK(plant.truth().position == sound.truth().position);
        return plant.position()[0] - sound.position()[0];
    };
    CHECK(difference(0.099) == 0);
    CHECK(difference(0.1) == Approx(0.05));
    CHECK(difference(0.199) == Approx(0.05));
    CHECK(difference(0.2) == Approx(-0.15));
    CHECK(difference(0.201) == Approx(0.05));
}

TEST_CASE("scaling and offset of a torque sensor change its reading with noise but not the torque") {
    Scenario scenario = quiet_scenario(1);
    scenario.torque_sensor.noise = JointVector::Constant(1, 0.3);
    SimulatedPlant sound = falling("[]", scenario);
    SimulatedPlant lying = falling(R"([{"kind": "torque_scale", "factor": 1.67, "from_s": 0.1, "for_s": 0.2},
                    {"kind": "torque_bias", "joint": 1, "nm": 20, "from_s": 0.2, "for_s": 0.2}])",
                                   scenario);
    const auto readings = [&](double time_s) {
        for (SimulatedPlant* const plant : {&sound, &lying}) {
            plant->apply(JointVector::Constant(1, 2));
            plant->advance_to(time_s);
        }
        CHECK(lying.truth().torque == sound.truth().torque);
        return std::pair{sound.torque()[0], lying.torque()[0]};
    };
    const auto check = [&](double time_s, double factor, double bias) {
        const auto [true_reading, false_reading] = readings(time_s);
        CHECK(true_reading != 2);
        CHECK(false_reading == Approx(factor * true_reading + bias).epsilon(1e-12));
    };
    check(0.05, 1, 0);
    check(0.15, 1.67, 0);
    check(0.25, 1.67, 20);
    check(0.35, 1, 20);
    check(0.45, 1, 0);
}

} // namespace sensor_faults_test
