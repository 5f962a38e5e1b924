// SPDX-License-Identifier: Apache-2.0
// Two recordings of one simulated arm through the program: `dfdyn diagnose --log a.csv --log b.csv`.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace diagnose_recordings_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::seed;
using dfdyn::tests::TemporaryDirectory;
using nlohmann::json;

const std::string urdf = DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf";
constexpr double load_kg = 0.6;

/// Friction of the simulated joints: viscous (N·m·s/rad) and dry (N·m).
const std::map<std::string, double> friction{{"viscous_friction joint1", 0.3},
                                             {"viscous_friction joint2", 0.2},
                                             {"coulomb_friction joint1", 0.8},
                                             {"coulomb_friction joint2", 0.5}};

/// A slow motion of the small arm, with friction without a Stribeck peak and with stiff bristles.
json scenario_of(std::uint64_t number, double highest_hz) {
    json scenario = json::parse(file_content(DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json"));
    scenario["seed"] = 100 * seed() + number;
    scenario["recording"]["rate_hz"] = 50;
    scenario["recording"]["samples"] = 500;
    scenario["recording"]["columns"] = {"q", "tau"};
    scenario["task"]["lowest_hz"] = 0.2;
    scenario["task"]["highest_hz"] = highest_hz;
    json& joints = scenario["actuators"]["friction"];
    joints["static_nm"] = joints["coulomb_nm"];
    joints["stiffness_nm_per_rad"] = {3000, 2000};
    return scenario;
}

/// Simulates a scenario. Returns DIRECTORY/NAME.
std::string simulated(const TemporaryDirectory& directory, const std::string& name, const json& scenario) {
    const std::string path = directory.write("scenario.json", scenario.dump());
    const std::string log = directory.path() / name;
    const Outcome outcome =
        run_program(directory, "simulate --robot " + urdf + " --scenario " + path + " -o " + log);
    CAPTURE(outcome.error);
    REQUIRE(outcome.status == 0);
    return log;
}

/// Simulates two motions. Returns `--log DIRECTORY/a.csv --log DIRECTORY/b.csv`.
std::string two_logs(const TemporaryDirectory& directory, bool load_in_second) {
    json second = scenario_of(1, 0.5);
    if (load_in_second) {
        second["payloads"] = {{{"mass_kg", load_kg}, {"centre_m", {0.02, 0.01, 0.05}}}};
    }
    return "--log " + simulated(directory, "a.csv", scenario_of(0, 0.7)) + " --log " +
           simulated(directory, "b.csv", second);
}

json diagnosis_of(const TemporaryDirectory& directory, const std::string& arguments) {
    const std::string folder = directory.path() / "out";
    const Outcome outcome =
        run_program(directory, "diagnose --robot " + urdf + " --tip tool --outputs tau --no-held-out -o " +
                                   folder + " " + arguments);
    CAPTURE(outcome.out, outcome.error);
    REQUIRE(outcome.status == 0);
    return json::parse(file_content(folder + "/diagnosis.json"));
}

bool within(const json& interval, double value) {
    return double(interval.at(0)) <= value && value <= double(interval.at(1));
}

/// Returns the payloads that are more likely present than not.
std::vector<json> probable_payloads(const json& diagnosis) {
    std::vector<json> payloads;
    for (const json& finding : diagnosis.at("findings")) {
        if (finding.at("effect") == "payload" && double(finding.at("confidence")) >= 0.5) {
            payloads.push_back(finding);
        }
    }
    return payloads;
}

/// Checks the common value of a friction, and its value in each recording. Returns whether it has the latter.
bool check_friction(const json& finding, double truth) {
    if (!finding.contains("by_recording")) {
        return false;
    }
    constexpr double near = 0.25; // part of the truth
    const json& all = finding.at("parameters").at(0);
    CHECK(within(all.at("ci95"), truth));
    const json& each = finding.at("by_recording");
    REQUIRE(each.size() == 2);
    CHECK(each[0].at("recording") == "a.csv");
    CHECK(each[1].at("recording") == "b.csv");
    for (const json& one : each) {
        CHECK(double(one.at("value")) == Approx(truth).epsilon(near));
        CHECK(within(one.at("ci95"), one.at("value")));
    }
    const double reach = double(all.at("ci95").at(1)) - double(all.at("value"));
    CHECK(double(finding.at("spread")) > 0);
    CHECK(reach > 1.9 * double(finding.at("spread"))); // the interval contains the spread
    return true;
}

TEST_CASE("diagnose names the load of the second of two recordings, and the friction of both") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const TemporaryDirectory directory;
    const json diagnosis = diagnosis_of(directory, two_logs(directory, true) + " --changed payload");
    CHECK(diagnosis.at("recordings") == json({"a.csv", "b.csv"}));

    const std::vector<json> payloads = probable_payloads(diagnosis);
    REQUIRE(payloads.size() == 1);
    const json& payload = payloads.front();
    CHECK(payload.at("only_in") == "b.csv");
    CHECK(payload.at("where") == "tool");
    const json& mass = payload.at("parameters").at(0);
    CHECK(mass.at("name") == "mass");
    CHECK(within(mass.at("ci95"), load_kg));
    CHECK(double(mass.at("value")) == Approx(load_kg).epsilon(0.15));

    int in_each = 0;
    for (const json& finding : diagnosis.at("findings")) {
        const std::string name = std::string(finding.at("effect")) + " " + std::string(finding.at("where"));
        const auto truth = friction.find(name);
        if (truth != friction.end()) {
            CAPTURE(name, finding.dump());
            CHECK(double(finding.at("confidence")) >= 0.5);
            in_each += check_friction(finding, truth->second) ? 1 : 0;
        }
    }
    CHECK(in_each >= 2); // a joint with a further kind of friction keeps the values of the joined recording
}

TEST_CASE("diagnose names no payload in two recordings without one") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const TemporaryDirectory directory;
    const json diagnosis = diagnosis_of(directory, two_logs(directory, false));
    CHECK(diagnosis.at("recordings") == json({"a.csv", "b.csv"}));
    CHECK(probable_payloads(diagnosis).empty());
    for (const json& finding : diagnosis.at("findings")) {
        CHECK_FALSE(finding.contains("only_in"));
    }
}

TEST_CASE("diagnose refuses --changed where it has no meaning") {
    const TemporaryDirectory directory;
    json scenario = scenario_of(0, 0.7);
    scenario["recording"]["samples"] = 50;
    scenario["recording"]["columns"] = {"q", "tau", "wrench"};
    const std::string log = "--log " + simulated(directory, "a.csv", scenario);
    const std::string logs = log + " --log " + simulated(directory, "b.csv", scenario);
    const auto refusal = [&](const std::string& arguments) {
        const Outcome outcome =
            run_program(directory, "diagnose --robot " + urdf + " --tip tool " + arguments + " -o " +
                                       (directory.path() / "out").string());
        CAPTURE(arguments, outcome.out);
        CHECK(outcome.status == 2);
        CHECK(outcome.out.empty());
        CHECK_FALSE(std::filesystem::exists(directory.path() / "out"));
        return outcome.error;
    };
    CHECK_THAT(refusal(log + " --outputs tau --changed payload"),
               ContainsSubstring("--changed: expected several recordings") &&
                   ContainsSubstring("found one recording"));
    CHECK_THAT(refusal(logs + " --outputs wrench --changed payload"),
               ContainsSubstring("--changed: expected") && ContainsSubstring("found --outputs wrench"));
    CHECK_THAT(refusal(logs + " --outputs tau --changed gravity"), ContainsSubstring("--changed: expected") &&
                                                                       ContainsSubstring("payload") &&
                                                                       ContainsSubstring("gravity"));
}

} // namespace diagnose_recordings_test
