// SPDX-License-Identifier: Apache-2.0
// Reading the faults of a scenario's file, and the times at which they act.
#include "tests/support/catch.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/base/system/read_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

namespace fault_reading_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;

/// The effect of a fault with these fields on a three-joint arm while it acts.
Faults acting(const std::string& fields) {
    Faults faults(3);
    faults_of("[{" + fields + "}]", 3).at(0).act(faults);
    return faults;
}

std::string refusal(const std::string& fields) {
    try {
        faults_of("[{" + fields + "}]", 3);
    } catch (const InputError& error) {
        return std::string(error.what()).substr(std::string("s.json: faults[0].").size());
    }
    return "none";
}

TEST_CASE("joints are one number or a list or all if not given") {
    const auto factors = [](const std::string& joint) {
        return acting(R"("kind": "friction_step", "factor": 3)" + joint).arm.friction_factor;
    };
    CHECK(factors("") == JointVector(Eigen::Vector3d(3, 3, 3)));
    CHECK(factors(R"(, "joint": 2)") == JointVector(Eigen::Vector3d(1, 3, 1)));
    CHECK(factors(R"(, "joint": [3, 1])") == JointVector(Eigen::Vector3d(3, 1, 3)));
}

TEST_CASE("simultaneous faults combine by product of factors and smallest limit and independent losses") {
    Faults faults(3);
    for (const Fault& fault : faults_of(R"([{"kind": "actuator_gain", "factor": 0.5},
             {"kind": "actuator_gain", "joint": 1, "factor": 0.5}, {"kind": "actuator_saturation", "limit_nm": 9},
             {"kind": "actuator_saturation", "joint": 3, "limit_nm": 4}, {"kind": "torque_bias", "nm": 2},
             {"kind": "torque_bias", "joint": 2, "nm": 1}, {"kind": "frames_lost", "share": 0.5},
             {"kind": "frames_lost", "share": 0.5}, {"kind": "late_ticks", "at_s": 0, "late_s": 0.003},
             {"kind": "late_ticks", "at_s": 0, "late_s": 0.002}, {"kind": "clock_jump", "at_s": 0, "by_s": 0.5},
             {"kind": "clock_jump", "at_s": 0, "by_s": -0.2, "clock": "wall"},
             {"kind": "clock_jump", "at_s": 0, "by_s": 1, "clock": "bus"}])",
                                        3)) {
        fault.act(faults);
    }
    CHECK(faults.arm.actuator_gain == JointVector(Eigen::Vector3d(0.25, 0.5, 0.5)));
    CHECK(faults.arm.actuator_limit == JointVector(Eigen::Vector3d(9, 9, 4)));
    CHECK(faults.torque_sensor.bias == JointVector(Eigen::Vector3d(2, 3, 2)));
    CHECK(faults.link.share_lost == 0.75);
    CHECK(faults.link.late_ns == 3'000'000);
    CHECK(faults.link.wall_set_ns == 300'000'000);
    CHECK(faults.link.bus_set_ns == 1'000'000'000);
}

TEST_CASE("a fault acts from its start until its end even if time runs backwards") {
    FaultSchedule schedule(faults_of(R"([{"kind": "cycles_lost", "cycles": 3, "at_s": 0.7},
        {"kind": "torque_bias", "nm": 1, "from_s": 0.702, "for_s": 1}])",
                                     1),
                           1);
    CHECK_FALSE(schedule.now().link.devices_silent);
    const auto at = [&](int tick) {
        schedule.go_to(0.001 * tick);
        return std::pair{schedule.now().link.devices_silent, schedule.now().torque_sensor.bias[0]};
    };
    for (const int tick : {0, 699, 700, 701, 702, 703, 1701, 1702, 5000, 702, 701, 699, 703}) {
        CAPTURE(tick);
        CHECK(at(tick).first == (tick >= 700 && tick < 703));
        CHECK(at(tick).second == (tick >= 702 && tick < 1702 ? 1 : 0));
    }
    CHECK(schedule.go_to(0.701));
    CHECK_FALSE(schedule.go_to(0.701));
    CHECK_FALSE(schedule.go_to(0.7015));
    CHECK(schedule.go_to(0.702));
}

TEST_CASE("an impossible fault is rejected with the expected and the found value") {
    CHECK_THAT(refusal(R"("kind": "gremlin")"), StartsWith("kind: expected friction_step, push, ") &&
                                                    ContainsSubstring(" or clock_jump, found \"gremlin\""));
    CHECK_THAT(refusal(R"("from_s": 1)"), StartsWith("kind: expected this field, found none"));
    CHECK_THAT(refusal(R"("kind": "friction_step", "factor": 2, "at_s": 1)"),
               StartsWith("field \"at_s\": expected one of kind, joint, factor, from_s, for_s"));
    CHECK_THAT(refusal(R"("kind": "friction_step")"), StartsWith("factor: expected this field"));
    CHECK_THAT(refusal(R"("kind": "friction_step", "factor": -1)"),
               StartsWith("factor: expected a number from 0"));
    CHECK_THAT(refusal(R"("kind": "torque_bias", "nm": 1, "joint": 4)"),
               StartsWith("joint: expected a whole number from 1 to 3, found \"4\""));
    CHECK_THAT(refusal(R"("kind": "torque_bias", "nm": 1, "joint": [1, 1])"),
               StartsWith("joint: expected each joint once, found 1 again"));
    CHECK_THAT(refusal(R"("kind": "encoder_frozen")"), StartsWith("joint: expected this field"));
    CHECK_THAT(refusal(R"("kind": "cycles_lost", "cycles": 0, "at_s": 1)"),
               StartsWith("cycles: expected a whole"));
    CHECK_THAT(refusal(R"("kind": "cycles_lost", "cycles": 1)"), StartsWith("at_s: expected this field"));
    CHECK_THAT(refusal(R"("kind": "frames_lost", "share": 1.5)"),
               StartsWith("share: expected a number from 0 to 1"));
    CHECK_THAT(refusal(R"("kind": "frames_lost", "share": 0.1, "for_s": 0)"), StartsWith("for_s: expected"));
    CHECK_THAT(refusal(R"("kind": "clock_jump", "at_s": 1, "by_s": 2)"),
               StartsWith("by_s: expected a number from -1 to 1"));
    CHECK_THAT(refusal(R"("kind": "clock_jump", "at_s": 1, "by_s": 1, "clock": "church")"),
               StartsWith("clock: expected wall or bus, found \"church\""));
    CHECK_THAT(refusal(R"("kind": "push")"), StartsWith("force_n: expected either force_n"));
    CHECK_THAT(refusal(R"("kind": "push", "force_n": [1, 2, 3], "torque_nm": 1)"),
               StartsWith("force_n: expected either"));
    CHECK_THAT(refusal(R"("kind": "push", "force_n": [1, 2, 3], "joint": 1)"),
               StartsWith("force_n: expected a link"));
    CHECK_THAT(refusal(R"("kind": "push", "force_n": [1, 2, 3], "point_m": [0, 0, 1])"),
               StartsWith("point_m: expected the link"));
    CHECK_THAT(refusal(R"("kind": "push", "torque_nm": 1, "link": 1)"),
               StartsWith("torque_nm: expected a joint"));
    CHECK_THAT(refusal(R"("kind": "push", "torque_nm": 1)"), StartsWith("joint: expected this field"));
}

const std::filesystem::path data = DFDYN_TEST_DATA_DIR;

TEST_CASE("the documentation of scenarios lists every kind of fault with its fields") {
    const std::string text = read_file(data / "../../docs/reference/scenario.md", "cannot be read");
    for (const FaultKind& kind : fault_catalogue()) {
        CAPTURE(kind.name);
        const std::size_t row = text.find("| `" + std::string(kind.name) + "` |");
        REQUIRE(row != std::string::npos);
        const std::string line = text.substr(row, text.find('\n', row) - row);
        for (const std::string_view field : kind.fields) {
            CHECK_THAT(line, ContainsSubstring("`" + std::string(field) + "`"));
        }
    }
}

TEST_CASE("every kind of fault has a readable scenario for the UR5 that contains it") {
    std::set<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(data / "loop_faults")) {
        if (entry.path().extension() == ".json") {
            CAPTURE(entry.path());
            const Robot robot = read_scenario_robot(data / "robots/ur5/ur5_robot.urdf", entry.path());
            const Scenario scenario = read_scenario(entry.path(), robot);
            const bool removal = std::ranges::any_of(
                scenario.payloads, [](const Payload& payload) { return payload.removed_s < 1e6; });
            CHECK((!scenario.faults.empty() || removal));
            const nlohmann::json json = nlohmann::json::parse(read_file(entry.path(), ""));
            for (const nlohmann::json& fault : json.value("faults", nlohmann::json::array())) {
                found.insert(fault.at("kind").get<std::string>());
            }
        }
    }
    for (const FaultKind& kind : fault_catalogue()) {
        CAPTURE(kind.name);
        CHECK(found.contains(std::string(kind.name)));
    }
}

} // namespace fault_reading_test
