// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extended_model.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/replay/replay.hpp"
#include "tools/robot/urdf/read_robot.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

namespace diagnose_command_test {

namespace tools = dfdyn::tools;

using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;
using nlohmann::json;

const std::string urdf = DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf";
const std::string arm = " --robot " + urdf + " --tip tool ";

/// Simulates 30 s of the small arm with friction and rotors but no other error. Returns DIRECTORY/run.csv.
std::string simulated(const TemporaryDirectory& directory, int seed = 3) {
    json scenario = json::parse(file_content(DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json"));
    scenario["recording"]["samples"] = 3000;
    scenario["recording"]["columns"] = {"q", "tau", "i"};
    scenario["seed"] = seed;
    const std::string path = directory.write("scenario.json", scenario.dump());
    const std::string log = directory.path() / ("run" + std::to_string(seed) + ".csv");
    const Outcome outcome =
        run_program(directory, "simulate --robot " + urdf + " --scenario " + path + " -o " + log);
    CAPTURE(outcome.error);
    REQUIRE(outcome.status == 0);
    return log;
}

/// The recording with its columns `q1`, `q2` ... multiplied by `factor`.
std::string with_positions_times(double factor, const std::string& log, const TemporaryDirectory& directory) {
    std::istringstream lines(file_content(log));
    std::string header;
    std::getline(lines, header);
    std::ostringstream text;
    text << header << '\n';
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::istringstream names(header);
        std::string separator;
        for (std::string field, name; std::getline(fields, field, ',') && std::getline(names, name, ',');) {
            text << separator;
            if (name.front() == 'q') {
                text << factor * std::stod(field);
            } else {
                text << field;
            }
            separator = ",";
        }
        text << '\n';
    }
    return directory.write("scaled.csv", text.str());
}

Outcome diagnose(const TemporaryDirectory& directory, const std::string& arguments) {
    return run_program(directory, "diagnose" + arm + arguments);
}

bool found(const json& diagnosis, const std::string& effect, const std::string& where) {
    for (const json& finding : diagnosis["findings"]) {
        if (finding["effect"] == effect && finding["where"] == where) {
            return true;
        }
    }
    return false;
}

double error_at_start(const tools::TrainedModel& model, const tools::Recording& recording) {
    const auto estimator = tools::make_estimator(model, false);
    const auto replayed = tools::replay(*estimator, {&model, 1}, recording, 0, [](std::size_t) {});
    double sum = 0;
    for (std::size_t output = 0; output < 2; ++output) {
        sum += tools::normalised_error(replayed, 2, output, 0, 100);
    }
    return sum;
}

TEST_CASE("diagnose names friction and rotors and writes report and figures and model") {
    const TemporaryDirectory directory;
    const std::string log = simulated(directory);
    const std::string folder = directory.path() / "out";
    const Outcome outcome = diagnose(directory, "--log " + log + " --outputs tau -o " + folder +
                                                    " --header " + folder + "/m.hpp --export urdf,mjcf,json");
    CAPTURE(outcome.out, outcome.error);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, StartsWith("error, rms"));
    CHECK_THAT(outcome.out, ContainsSubstring("viscous friction at joint1: viscous") &&
                                ContainsSubstring("report: " + folder + "/report.html"));
    CHECK(std::count(outcome.out.begin(), outcome.out.end(), '\n') <= 40);

    const json diagnosis = json::parse(file_content(folder + "/diagnosis.json"));
    CHECK(diagnosis["schema"] == "dfdyn.diagnosis/1");
    CHECK(diagnosis["outputs"] == json({"tau1", "tau2"}));
    CHECK(diagnosis["suspicions"].empty());
    CHECK(diagnosis["refused"] == false);
    CHECK(diagnosis["refusals"].empty());
    CHECK(found(diagnosis, "rotor_inertia", "joint1"));
    CHECK(found(diagnosis, "viscous_friction", "joint2"));
    CHECK(double(diagnosis["heldout"]["from"]) < double(diagnosis["heldout"]["to"]));
    for (const std::size_t output : {0U, 1U}) {
        CHECK(double(diagnosis["extended"]["rms"][output]) <
              0.5 * double(diagnosis["nominal"]["rms"][output]));
    }
    for (const json& finding : diagnosis["findings"]) {
        CHECK(finding["confidence"].is_number());
        CHECK_FALSE(finding["evidence"].get<std::string>().empty());
        CHECK_FALSE(finding["confirm"].get<std::string>().empty());
        CHECK(finding["gain"]["rms_before"].is_number());
    }

    tools::ReadRobotOptions chain;
    chain.tip = "tool";
    const tools::Robot corrected = tools::read_robot(folder + "/corrected_robot.urdf", chain);
    CHECK(corrected.joints.size() == 2);
    const json exported = json::parse(file_content(folder + "/corrected_robot.json"));
    CHECK(double(exported["joints"][0]["armature"]) > 0);
    CHECK(double(exported["joints"][1]["damping"]) > 0);
    CHECK_THAT(file_content(folder + "/corrected_robot.xml"), ContainsSubstring("<mujoco model="));

    const std::string page = file_content(folder + "/report.html");
    for (const char* part : {"What the simulation of", "Measured, simulated, extended", "Remaining error",
                             "viscous friction at joint1", "Considered and rejected",
                             "As an online learner sees it", "velocity of joint 1 (rad/s)"}) {
        CHECK_THAT(page, ContainsSubstring(part));
    }
    CHECK(page.find("https://") == std::string::npos);
    CHECK(page.find("nan") == std::string::npos);

    const Outcome replayed =
        run_program(directory, "replay --model " + folder + "/extended_model.json --log " + log);
    CAPTURE(replayed.error);
    CHECK(replayed.status == 0);
    const std::string use =
        directory.write("use.cpp", "#include \"out/m.hpp\"\n"
                                   "dfdyn::Estimator<m::Model> estimator(m::constants);\n");
    const std::string check = std::string(DFDYN_CXX) +
                              " -std=c++20 -Wall -Wextra -Werror -fno-exceptions -fsyntax-only -I " +
                              DFDYN_FIRMWARE_INCLUDE + " " + use;
    CHECK(std::system(check.c_str()) == 0);
}

TEST_CASE("the extended model is more accurate than the nominal one from the first second") {
    const TemporaryDirectory directory;
    const std::string log = simulated(directory, 4);
    tools::ReadRobotOptions chain;
    chain.tip = "tool";
    const tools::Robot robot = tools::read_robot(urdf, chain);
    tools::ReadOptions columns;
    columns.outputs = tools::OutputKind::joint_torque;
    const std::vector<tools::Recording> recordings{tools::read_recording(log, columns)};
    tools::DiagnosisOptions options;
    options.measure = false;
    const tools::DiagnosisWork work = tools::diagnose(robot, recordings.front(), options);
    const tools::ModelExtension extension = tools::extension_of(work);
    REQUIRE_FALSE(extension.columns.empty());
    const tools::TrainedModel extended = tools::extended_model(extension, recordings);
    const double nominal =
        error_at_start(tools::extended_model(tools::nominal_extension(work), recordings), recordings.front());
    const double with_names = error_at_start(extended, recordings.front());
    CAPTURE(nominal, with_names);
    CHECK(with_names < 0.5 * nominal);
    const std::string text = tools::model_to_json(extended);
    CHECK(tools::model_to_json(tools::model_from_json(text, "m.json")) == text);
}

TEST_CASE("a recording in degrees is reported first and gets no model") {
    const TemporaryDirectory directory;
    const std::string log = with_positions_times(57.29578, simulated(directory), directory);
    const std::string folder = directory.path() / "out";
    std::filesystem::create_directory(folder);
    directory.write("out/extended_model.json", "of an earlier run");
    const Outcome outcome = diagnose(directory, "--log " + log + " --outputs tau -o " + folder);
    CAPTURE(outcome.out, outcome.error);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.out,
               StartsWith("! positions of joint 1, 2") && ContainsSubstring("looks like degrees"));
    const json diagnosis = json::parse(file_content(folder + "/diagnosis.json"));
    REQUIRE(diagnosis["suspicions"].size() == 1);
    CHECK(diagnosis["refused"] == true);
    REQUIRE(diagnosis["refusals"].size() == 1);
    CHECK(diagnosis["refusals"][0]["code"] == "position_unit");
    CHECK(diagnosis["refusals"][0]["where"] == "q1, q2");
    CHECK(diagnosis["refusals"][0]["text"] == diagnosis["suspicions"][0]);
    CHECK(diagnosis["findings"].empty());
    CHECK_THAT(file_content(folder + "/report.html"), ContainsSubstring("looks like degrees"));
    CHECK_FALSE(std::filesystem::exists(folder + "/extended_model.json"));
    // a header in the new folder, whose path is written in two ways, and one outside of it
    const std::string earlier = directory.write("m.hpp", "of an earlier run");
    for (const std::string header : {"./new/m.hpp", "m.hpp"}) {
        const std::string outputs = " --outputs tau -o new --header " + header;
        CHECK(run_program(directory, "diagnose" + arm + "--log " + log + outputs, directory.path()).status ==
              1);
    }
    CHECK_FALSE(std::filesystem::exists(earlier));
}

TEST_CASE("the extended model of a recording in degrees reads others in degrees") {
    const TemporaryDirectory directory;
    const std::string log = simulated(directory);
    const std::string degrees = with_positions_times(180 / std::numbers::pi, log, directory);
    const std::string folder = directory.path() / "out";
    const Outcome outcome =
        diagnose(directory, "--log " + degrees + " --units q=deg --outputs tau --no-held-out -o " + folder);
    CAPTURE(outcome.error);
    REQUIRE(outcome.status == 0);
    const json training = json::parse(file_content(folder + "/extended_model.json"))["training"];
    CHECK(training["units"] == "q=deg");
    CHECK(training["joint_names"].size() == 2);
    const Outcome replayed =
        run_program(directory, "replay --model " + folder + "/extended_model.json --log " + degrees);
    CAPTURE(replayed.out, replayed.error);
    CHECK(replayed.status == 0);
}

TEST_CASE("currents with unknown torque constants in several recordings are diagnosed") {
    const TemporaryDirectory directory;
    const std::string logs = simulated(directory, 5) + "," + simulated(directory, 6);
    const std::string folder = directory.path() / "out";
    const Outcome outcome = diagnose(directory, "--log " + logs + " --outputs i --no-held-out -o " + folder);
    CAPTURE(outcome.out, outcome.error);
    REQUIRE(outcome.status == 0);
    CHECK_THAT(outcome.out, ContainsSubstring("over the whole recording"));
    const json diagnosis = json::parse(file_content(folder + "/diagnosis.json"));
    CHECK(found(diagnosis, "viscous_friction", "joint1"));
    CHECK_THAT(outcome.out, ContainsSubstring("torque constants, N·m/A: actuator1 "));
    REQUIRE(diagnosis["granted"].size() >= 2);
    const std::array constants{5.0, 3.0}; // of the scenario
    std::size_t joint = 0;
    for (const json& estimate : diagnosis["granted"]) {
        if (estimate["name"] == "torque_constant") {
            CHECK(double(estimate["value"]) == Approx(constants.at(joint++)).epsilon(0.1));
        }
    }
    CHECK(joint == 2);
    CHECK(run_program(directory, "replay --model " + folder + "/extended_model.json --log " + logs).status ==
          0);
}

TEST_CASE("diagnose rejects unusable input with one line") {
    const TemporaryDirectory directory;
    const std::string log = simulated(directory);
    const std::string rest = "--log " + log + " -o " + (directory.path() / "out").string() + " ";
    const auto refusal = [&](const std::string& arguments) {
        const Outcome outcome = diagnose(directory, arguments);
        CHECK(outcome.status == 2);
        return outcome.error;
    };
    CHECK_THAT(refusal(rest + "--outputs torque"), ContainsSubstring("tau"));
    CHECK_THAT(refusal(rest + "--outputs wrench --tip link2"), ContainsSubstring("--tip"));
    CHECK_THAT(refusal(rest + "--outputs tau --torque-constants 1,2"),
               ContainsSubstring("--torque-constants"));
    CHECK_THAT(refusal(rest + "--outputs i --torque-constants 1,2,3"), ContainsSubstring("expected 2"));
    CHECK_THAT(refusal(rest + "--outputs i --torque-constants 1,-2"), ContainsSubstring("above 0"));
    CHECK_THAT(refusal("--log nowhere.csv --outputs tau -o out"), ContainsSubstring("nowhere.csv"));
    CHECK_THAT(refusal("--log " + log + " --outputs tau -o " + log), ContainsSubstring(log));
    CHECK_THAT(run_program(directory, "diagnose --help").out, ContainsSubstring("Example:"));
}

} // namespace diagnose_command_test
