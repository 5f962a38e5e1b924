// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tools/base/text/error.hpp"

#include <nlohmann/json.hpp>

#include <numeric>
#include <vector>

namespace scenario_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using nlohmann::json;

json minimal() {
    return json::parse(R"({
        "schema": "dfdyn.scenario/1",
        "chain": {"tip": "rod"},
        "recording": {"rate_hz": 50, "samples": 20, "columns": ["q", "tau"]},
        "task": {"kind": "multisine", "centre_rad": 0.1, "amplitude_rad": 0.2, "lowest_hz": 0.1,
                 "highest_hz": 0.5, "tones": 3},
        "controller": {"kind": "gravity_compensation", "position_gain": 100, "velocity_gain": [9]},
        "actuators": {"friction": {"viscous_nms_per_rad": 0.3}},
        "encoders": {"bits_per_turn": 14},
        "derivatives": {"velocity_window": 8, "acceleration_window": 12}
    })");
}

Scenario read(const json& scenario, const Robot& robot = pendulum(1, 1)) {
    const TemporaryDirectory directory;
    return read_scenario(directory.write("s.json", scenario.dump()), robot);
}

/// The error message for the minimal scenario with `value` at `path`.
std::string error_with(const std::string& path, const json& value) {
    json scenario = minimal();
    scenario[json::json_pointer(path)] = value;
    try {
        read(scenario);
    } catch (const InputError& error) {
        const std::string text = error.what();
        return text.substr(text.find("s.json: ") + 8);
    }
    return "none";
}

TEST_CASE("a scenario is read with its defaults and with one number for all joints or one for each") {
    const Scenario scenario = read(minimal());
    CHECK(scenario.integration_rate_hz == 8000);
    CHECK(scenario.recording.samples == 20);
    CHECK(scenario.controller.kind == ControllerKind::gravity_compensation);
    CHECK(scenario.controller.position_gain[0] == 100);
    CHECK(scenario.controller.velocity_gain[0] == 9);
    CHECK(scenario.actuators.friction[0].viscous == 0.3);
    CHECK(scenario.actuators.friction[0].stiffness == 0);
    CHECK_FALSE(scenario.actuators.torque_limit);
    CHECK(scenario.encoders.bits_per_turn == 14);
    CHECK_FALSE(scenario.force_torque);
    CHECK(std::get<MultisineTask>(scenario.task).amplitude[0] == 0.2);
}

TEST_CASE("an invalid scenario is rejected with the path of the field and the expected and the found value") {
    using Catch::Matchers::ContainsSubstring;
    using Catch::Matchers::StartsWith;
    CHECK_THAT(error_with("/colour", 3), StartsWith("field \"colour\": expected one of schema, chain, "));
    CHECK_THAT(error_with("/actuators/friction/colomb_nm", 3),
               StartsWith("actuators.friction.field \"colomb_nm\""));
    CHECK_THAT(error_with("/task/tones", 0), StartsWith("task.tones: expected a whole number from 1"));
    CHECK_THAT(error_with("/task/kind", "dance"),
               StartsWith("task.kind: expected multisine, tones, point_to_point or circle, found \"dance\""));
    CHECK_THAT(error_with("/task/highest_hz", 0.05),
               StartsWith("task.highest_hz: expected a number from 0.1"));
    CHECK_THAT(error_with("/controller/velocity_gain", {1, 2}),
               StartsWith("controller.velocity_gain: expected 1 numbers"));
    CHECK_THAT(error_with("/controller/kind", "none"),
               StartsWith("controller.kind: expected computed_torque"));
    CHECK_THAT(error_with("/controller/rate_hz", 3000),
               StartsWith("controller.rate_hz: expected integration_rate_hz to be a multiple of it"));
    CHECK_THAT(error_with("/encoders/rate_hz", 16000),
               StartsWith("encoders.rate_hz: expected integration_rate_hz"));
    CHECK_THAT(error_with("/derivatives/rate_hz", 300),
               StartsWith("derivatives.rate_hz: expected encoders.rate_hz to be a multiple of it"));
    CHECK_THAT(error_with("/recording/columns", {"q", "q"}),
               StartsWith("recording.columns: expected some of"));
    CHECK_THAT(error_with("/recording/columns", {"wrench"}),
               StartsWith("recording.columns: expected force_torque"));
    CHECK_THAT(error_with("/recording/columns", {"i"}),
               StartsWith("recording.columns: expected actuators.torque_constant"));
    CHECK_THAT(error_with("/recording/stamp_jitter_s", 0.01),
               StartsWith("recording.stamp_jitter_s: expected a number"));
    CHECK_THAT(error_with("/force_torque", json::object()),
               ContainsSubstring(
                   "expected a robot with a force/torque sensor, found none on the chain base to rod"));
    CHECK_THAT(error_with("/actuators/friction/stiffness_nm_per_rad", 100),
               StartsWith("actuators.friction.coulomb_nm: expected bristles to have"));
    CHECK_THAT(error_with("/actuators/friction/coulomb_nm", 1),
               StartsWith("actuators.friction.static_nm: expected at least coulomb_nm"));
    CHECK_THAT(error_with("/actuators/torque_limit_nm", -1),
               StartsWith("actuators.torque_limit_nm: expected positive"));
    json missing = minimal();
    missing.erase("controller");
    CHECK_THROWS_WITH(read(missing), ContainsSubstring("controller: expected this field, found none"));
}

/// A chain of `joints` pendulums, one on the other.
Robot chain_of(std::size_t joints) {
    Robot robot = pendulum(1, 1);
    const RobotJoint joint = robot.joints.front();
    robot.joints.assign(joints, joint);
    return robot;
}

TEST_CASE("a robot with more joints than a simulation holds is refused before any field per joint is read") {
    json scenario = minimal();
    scenario["controller"]["velocity_gain"] = 9;
    CHECK(read(scenario, chain_of(12)).controller.velocity_gain.size() == 12);
    CHECK_THROWS_WITH(read(scenario, chain_of(13)),
                      "robot pendulum: expected a chain of 1 to 12 joints, found 13");
    CHECK_THROWS_WITH(read(scenario, chain_of(0)),
                      "robot pendulum: expected a chain of 1 to 12 joints, found 0");
}

TEST_CASE("joints with a soft gear count twice towards the longest chain of a scenario") {
    json scenario = minimal();
    scenario["controller"]["velocity_gain"] = 9;
    scenario["actuators"]["rotor_inertia_kgm2"] = 0.1;
    scenario["actuators"]["gear"]["stiffness_nm_per_rad"] = {500, 500, 500, 500, 500, 0, 0};
    CHECK_NOTHROW(read(scenario, chain_of(7)));
    scenario["actuators"]["gear"]["stiffness_nm_per_rad"] = 500;
    CHECK_THROWS_WITH(
        read(scenario, chain_of(7)),
        Catch::Matchers::ContainsSubstring("s.json: actuators.gear.stiffness_nm_per_rad: expected "
                                           "at most 12 joints, each soft one counted twice, "
                                           "found 14"));
}

TEST_CASE("an impossible value of an actuator is reported with its field and its value") {
    const std::string not_negative = ": expected numbers that are not negative, found ";
    const auto message = [&](const std::string& field) { return "actuators." + field + not_negative; };
    CHECK(error_with("/actuators/rotor_inertia_kgm2", -0.5) == message("rotor_inertia_kgm2") + "-0.5");
    json gear = {{"stiffness_nm_per_rad", -2}};
    CHECK(error_with("/actuators/gear", gear) == message("gear.stiffness_nm_per_rad") + "-2");
    gear = {{"damping_nms_per_rad", -3}};
    CHECK(error_with("/actuators/gear", gear) == message("gear.damping_nms_per_rad") + "-3");
    gear = {{"gap_rad", -0.25}};
    CHECK(error_with("/actuators/gear", gear) == message("gear.gap_rad") + "-0.25");
    for (const std::string name : {"stiffness_nm_per_rad", "damping_nms_per_rad", "viscous_nms_per_rad",
                                   "coulomb_nm", "coulomb_negative_nm", "load_coefficient"}) {
        CHECK(error_with("/actuators/friction/" + name, -4) == message("friction." + name) + "-4");
    }
    CHECK(error_with("/actuators/torque_delay_s", 11) ==
          "actuators.torque_delay_s: expected numbers from 0 to 10, found 11");
    json two_joints = minimal();
    two_joints["controller"]["velocity_gain"] = 9;
    two_joints["actuators"]["torque_delay_s"] = {0, 11};
    CHECK_THROWS_WITH(read(two_joints, chain_of(2)),
                      Catch::Matchers::ContainsSubstring("numbers from 0 to 10, found 11"));
}

TEST_CASE("friction that needs bristles is refused at a joint without them") {
    const std::string expected =
        "actuators.friction.stiffness_nm_per_rad: expected a positive number at every "
        "joint with other than viscous friction, found 0";
    CHECK(error_with("/actuators/friction", {{"coulomb_nm", 1}, {"static_nm", 1}}) == expected);
    for (const std::string name :
         {"static_nm", "coulomb_negative_nm", "load_coefficient", "damping_nms_per_rad"}) {
        CAPTURE(name);
        CHECK(error_with("/actuators/friction/" + name, 0.1) == expected);
    }
}

TEST_CASE("the calibration matrix of the F/T sensor is read row by row") {
    json scenario = minimal();
    std::vector<double> numbers(36);
    std::iota(numbers.begin(), numbers.end(), 0.0);
    scenario["force_torque"] = {{"range", {1, 1, 1, 1, 1, 1}}, {"calibration", numbers}};
    Robot robot = pendulum(1, 1);
    robot.sensor.emplace();
    CHECK(read(scenario, robot).force_torque->calibration(1, 0) == 6);
    numbers.pop_back();
    scenario["force_torque"]["calibration"] = numbers;
    CHECK_THROWS_WITH(read(scenario, robot),
                      Catch::Matchers::ContainsSubstring("force_torque.calibration: expected 36 numbers"));
}

TEST_CASE("deviations from the robot's description are read or rejected if they are impossible") {
    using Catch::Matchers::StartsWith;
    json scenario = minimal();
    scenario["recording"]["noise"] = {{"torque_nm", 0.2}, {"coefficient", 0.9}};
    scenario["arm"] = {{"links", {{{"link", 1}, {"delta_mass_kg", 0.2}, {"delta_centre_m", {0, 0, 0.01}}}}},
                       {"tilt_rad", {0.01, -0.02}},
                       {"start_offset_rad", -0.1},
                       {"springs", {{"stiffness_nm_per_rad", 3}, {"rest_rad", 0.5}}}};
    scenario["contacts"] = {{{"start_s", 1}, {"end_s", 2}, {"joint", 1}, {"peak_nm", -4}},
                            {{"start_s", 3}, {"end_s", 5}, {"force_n", {1, 2, 3}}}};
    json& actuators = scenario["actuators"];
    actuators.update(
        {{"rotor_inertia_kgm2", 0.1},
         {"bandwidth_hz", 50},
         {"torque_gain", 1.1},
         {"torque_offset_nm", 0.3},
         {"torque_delay_s", 0.002},
         {"gear", {{"stiffness_nm_per_rad", 500}, {"damping_nms_per_rad", 1}, {"gap_rad", 0.01}}},
         {"ripple", {{"amplitude_nm", 0.4}, {"cycles_per_turn", 6}, {"phase_rad", 1}}}});
    actuators["friction"] = {{"stiffness_nm_per_rad", 100},
                             {"coulomb_nm", 1},
                             {"static_nm", 1},
                             {"stribeck_velocity_rad_per_s", 0.1},
                             {"coulomb_negative_nm", 1.5},
                             {"load_coefficient", 0.2},
                             {"drift_per_s", 0.01}};
    scenario["encoders"]["offset_rad"] = 0.02;
    const Scenario read_back = read(scenario);
    CHECK(read_back.output_noise->coefficient == 0.9);
    CHECK(read_back.robot_errors.links.at(0).delta_centre.z() == 0.01);
    CHECK(read_back.robot_errors.tilt_y == -0.02);
    CHECK(read_back.loads.springs->rest[0] == 0.5);
    CHECK(read_back.start_offset[0] == -0.1);
    CHECK(read_back.loads.ripple->cycles[0] == 6);
    CHECK(read_back.loads.contacts.at(0).joint == 0);
    CHECK(read_back.loads.contacts.at(0).peak == -4);
    CHECK_FALSE(read_back.loads.contacts.at(1).joint);
    CHECK(read_back.loads.contacts.at(1).force.z() == 3);
    CHECK(read_back.actuators.gear.gap[0] == 0.01);
    CHECK(read_back.actuators.friction[0].negative_excess == 0.5);
    CHECK(read_back.actuators.friction[0].load_coefficient == 0.2);
    CHECK(read_back.torque_sensor.gain->operator[](0) == 1.1);
    CHECK(read_back.torque_sensor.delay_s->operator[](0) == 0.002);
    CHECK(read_back.encoders.offset->operator[](0) == 0.02);

    CHECK_THAT(error_with("/contacts", {{{"start_s", 1}, {"end_s", 2}}}),
               StartsWith("contacts[0].joint: expected either joint and peak_nm, or force_n"));
    CHECK_THAT(error_with("/actuators/gear", {{"stiffness_nm_per_rad", 5}}),
               StartsWith("actuators.gear.stiffness_nm_per_rad: expected a rotor_inertia_kgm2"));
    CHECK_THAT(error_with("/actuators/gear", {{"gap_rad", 0.1}}), StartsWith("actuators.gear.gap_rad"));
    CHECK_THAT(error_with("/actuators/torque_delay_s", -1), StartsWith("actuators.torque_delay_s"));
    CHECK_THAT(error_with("/recording/noise", {{"series", {1, 2}}}), StartsWith("recording.noise.series"));
    CHECK_THAT(error_with("/arm", {{"links", {{{"link", 2}}}}}), StartsWith("arm.links[0].link"));
}

TEST_CASE("payloads that are removed and faults in ticks of the controller are read") {
    json scenario = minimal();
    scenario["payloads"] = {{{"mass_kg", 1}, {"centre_m", {0, 0, 0}}, {"attached_s", 2}, {"removed_s", 3}}};
    scenario["faults"] = {{{"kind", "cycles_lost"}, {"at_s", 2}, {"cycles", 3}}};
    scenario["controller"]["rate_hz"] = 500;
    const Scenario read_back = read(scenario);
    CHECK(read_back.payloads.at(0).removed_s == 3);
    CHECK(read_back.faults.at(0).from_ns == 2'000'000'000);
    CHECK(read_back.faults.at(0).until_ns == 2'006'000'000);
    CHECK(read(minimal()).faults.empty());
    CHECK_THAT(error_with("/payloads",
                          {{{"mass_kg", 1}, {"centre_m", {0, 0, 0}}, {"attached_s", 2}, {"removed_s", 2}}}),
               Catch::Matchers::StartsWith("payloads[0].removed_s: expected a number from 2.001"));
    CHECK_THAT(error_with("/faults", {{{"kind", "push"}, {"force", 3}}}),
               Catch::Matchers::StartsWith("faults[0].field \"force\": expected one of kind, force_n, "));
}

TEST_CASE("a file that is not a scenario is rejected") {
    const TemporaryDirectory directory;
    CHECK_THROWS_AS(read_scenario_chain(directory.path() / "none.json"), InputError);
    CHECK_THROWS_AS(read_scenario_chain(directory.path()), InputError);
    CHECK_THROWS_WITH(read_scenario_chain(directory.write("a.json", R"({"schema": "dfdyn.model/1"})")),
                      Catch::Matchers::ContainsSubstring("schema: expected dfdyn.scenario/1"));
    CHECK(read_scenario_chain(directory.write("b.json", minimal().dump())).tip == "rod");
}

} // namespace scenario_test
