// SPDX-License-Identifier: Apache-2.0
// `dfdyn loop` and `dfdyn plant` from the command line; tests/vcan has the tests over a bus.
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>

namespace loop_commands_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string data = DFDYN_TEST_DATA_DIR;
const std::string robot = " --robot " + data + "/robots/small_arm/small_arm.urdf";
const std::string bus = " --bus " + data + "/can/small_arm_loop.json";

std::string scenario_text() { return file_content(data + "/scenarios/small_arm_loop.json"); }

/// Runs the program with the small arm and its scenario, in which `from` is replaced with `to`.
class Bench {
  public:
    explicit Bench(const std::string& from = "", const std::string& to = "") {
        std::string text = scenario_text();
        if (!from.empty()) {
            text.replace(text.find(from), from.size(), to);
        }
        directory_.write("s.json", text);
    }
    std::string path(const std::string& name) const { return directory_.path() / name; }
    void write(const std::string& name, const std::string& text) const { directory_.write(name, text); }
    Outcome call(const std::string& arguments) const { return run_program(directory_, arguments); }
    Outcome loop(const std::string& arguments) const {
        return call("loop" + robot + " --scenario " + path("s.json") + arguments);
    }
    /// The error of a loop that does not start.
    std::string refusal(const std::string& arguments) const {
        const Outcome outcome = loop(arguments);
        CHECK(outcome.status == 2);
        CHECK(outcome.out.empty());
        CHECK(std::ranges::count(outcome.error, '\n') == 1);
        return outcome.error;
    }

  private:
    TemporaryDirectory directory_;
};

const std::string simulate = " --simulate --duration 11";

TEST_CASE("a loop with a model trained on its own simulated recording tracks better") {
    const Bench bench(R"("encoders")",
                      R"("payloads": [{"mass_kg": 0.5, "centre_m": [0, 0, 0]}], "encoders")");
    const Outcome nominal = bench.loop(simulate + bus + " -o " + bench.path("nominal"));
    CHECK(nominal.error.empty());
    REQUIRE(nominal.status == 0);
    CHECK_THAT(nominal.out, ContainsSubstring("nominal loop: "));
    CHECK_THAT(nominal.out, ContainsSubstring("running (none)"));
    const std::string log = bench.path("nominal/nominal.csv");
    CHECK(std::ranges::count(file_content(log), '\n') == 1101);
    REQUIRE(bench
                .call("train --outputs tau --model P --effects viscous_friction,rotor_inertia --starts 1 "
                      "--tip tool" +
                      robot + " --log " + log + " -o " + bench.path("m.json"))
                .status == 0);
    const Outcome learned =
        bench.loop(simulate + bus + " --model " + bench.path("m.json") + " -o " + bench.path("learned"));
    REQUIRE(learned.status == 0);
    CHECK_THAT(learned.out, ContainsSubstring("learning: "));
    const std::string last = learned.out.substr(learned.out.rfind('\n', learned.out.size() - 2) + 1);
    const double ratio = std::stod(last.substr(last.find_last_of(' ') + 1));
    CHECK(ratio > 3);
    for (const char* const name :
         {"nominal.csv", "learned.csv", "tracking.csv", "tracking.svg", "tracking.html"}) {
        CHECK(std::filesystem::exists(bench.path("learned") + "/" + name));
    }

    const auto changes = nlohmann::json::parse(file_content(bench.path("learned/changes.json")));
    REQUIRE(changes["recordings"].size() == 2);
    CHECK(changes["recordings"][0]["recording"] == "learned_alone");
    CHECK(changes["recordings"][1]["recording"] == "learned");

    const std::string model = " --observer-bandwidth 0 --model " + bench.path("m.json");
    const std::string saved = bench.path("learned.bin");
    REQUIRE(bench.loop(simulate + bus + model + " --save " + saved).status == 0);
    CHECK(bench.loop(simulate + bus + model + " --restore " + saved).status == 0);
    CHECK_THAT(bench.refusal(simulate + model + " --restore " + log), ContainsSubstring("expected what"));
}

TEST_CASE("a loop without a model cannot save or restore a learned state") {
    const Bench bench;
    CHECK_THAT(bench.refusal(simulate + " --save s.bin"), ContainsSubstring("expected --model, found none"));
}

TEST_CASE("the same loop command prints the same text") {
    const Bench bench;
    CHECK(bench.loop(simulate + bus).out == bench.loop(simulate + bus).out);
}

TEST_CASE("a loop requires a source of positions and a simulated loop a duration") {
    const Bench bench;
    CHECK_THAT(bench.refusal(""), ContainsSubstring("expected one of --simulate and --can, found none"));
    CHECK_THAT(bench.refusal(" --simulate --can can0"), ContainsSubstring("found both"));
    CHECK_THAT(bench.refusal(" --simulate"), ContainsSubstring("expected --duration, found none"));
    CHECK_THAT(bench.refusal(" --can can0"), ContainsSubstring("expected --bus, found none"));
    CHECK(bench.loop(" --simulate --duration -1").status == 2);
    CHECK(bench.loop(" --simulate --duration nan").status == 2);
}

TEST_CASE("a simulated loop that stops by itself ends with status 1 and the reason") {
    const Bench bench("\"position_gain\": [25, 12]", "\"position_gain\": [-25, -12]");
    const Outcome outcome = bench.loop(simulate + bus);
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.out, ContainsSubstring("stopped (following_error of joint 2)"));
    CHECK_THAT(outcome.out, !ContainsSubstring("tracking error"));
    const auto json = nlohmann::json::parse(bench.loop(simulate + bus + " --json").out);
    CHECK(json.at("stopped") == true);
    const auto& loop = json.at("loops").at(0);
    CHECK(loop.at("cause") == "following_error");
    CHECK(loop.at("ticks") > loop.at("followed_reference"));
    CHECK(loop.at("largest_torque_step_nm").size() == 2);
}

TEST_CASE("a fault of the scenario affects a simulated loop in the same way on every run") {
    const std::string place = R"("encoders")";
    const auto with = [&](const std::string& fault) { return R"("faults": [)" + fault + "], " + place; };
    const Bench glitch(
        place, with(R"({"kind": "encoder_jump", "joint": 2, "rad": 0.02, "at_s": 5, "for_s": 0.01})"));
    const Outcome struck = glitch.loop(simulate + bus);
    REQUIRE(struck.status == 0);
    CHECK_THAT(struck.out, ContainsSubstring("peaks: command, from tick to tick, by "));
    CHECK(struck.out == glitch.loop(simulate + bus).out);
    CHECK(struck.out != Bench().loop(simulate + bus).out);
    const Bench silence(place, with(R"({"kind": "cycles_lost", "cycles": 100, "at_s": 5})"));
    const Outcome stopped = silence.loop(simulate + bus);
    CHECK(stopped.status == 1);
    CHECK_THAT(stopped.out, ContainsSubstring("stopped (no_position)"));
    CHECK_THAT(Bench(place, with(R"({"kind": "gremlin"})")).refusal(simulate),
               ContainsSubstring("faults[0].kind: expected friction_step, push, "));
    CHECK_THAT(silence.call("loop --help").out, ContainsSubstring("late_ticks and clock_jump"));
}

TEST_CASE("given limits stop a loop that exceeds them and invalid limits are rejected") {
    const Bench bench;
    const Outcome error = bench.loop(simulate + bus + " --following-error 0.0001");
    CHECK(error.status == 1);
    CHECK_THAT(error.out, ContainsSubstring("stopped (following_error of joint 2)"));
    const Outcome speed = bench.loop(simulate + bus + " --speed-limit 20,0.1");
    CHECK(speed.status == 1);
    CHECK_THAT(speed.out, ContainsSubstring("stopped (overspeed of joint 2)"));
    CHECK(bench.loop(simulate + bus + " --following-error 0.4 --speed-limit 15 --stop hold").status == 0);
    CHECK_THAT(bench.refusal(simulate + " --speed-limit 1,2,3"),
               ContainsSubstring("--speed-limit: expected 1 value, or one for each of 2 joints, found 3"));
    CHECK(bench.loop(simulate + " --following-error 0").status == 2);
    CHECK(bench.loop(simulate + " --stop soft").status == 2);
    CHECK_THAT(bench.refusal(simulate + " --stop limp"),
               ContainsSubstring("--stop limp: expected --can, found --simulate, which ends at the stop"));
    for (const char* const of_model : {" --from-prior", " --learned-limit 0.2"}) {
        CHECK_THAT(bench.refusal(simulate + of_model), ContainsSubstring("expected --model, found none"));
    }
    CHECK_THAT(bench.refusal(simulate + " --window 0.0001"),
               ContainsSubstring("--window: expected at least a period of the loop, "));
}

TEST_CASE("a missing CAN interface is reported by the loop and by the plant") {
    const Bench bench;
    CHECK_THAT(bench.refusal(" --can nosuch0" + bus), ContainsSubstring("nosuch0"));
    const Outcome plant = bench.call("plant" + robot + " --scenario " + bench.path("s.json") + bus +
                                     " --can nosuch0 --duration 1");
    CHECK(plant.status == 2);
    CHECK_THAT(plant.error, ContainsSubstring("nosuch0"));
    CHECK(std::ranges::count(plant.error, '\n') == 1);
}

TEST_CASE("arguments of a loop that do not fit together are rejected before anything runs") {
    const Bench bench;
    CHECK_THAT(Bench("feed_forward", "computed_torque").refusal(simulate),
               ContainsSubstring("controller.kind: expected feed_forward"));
    CHECK_THAT(Bench("\"controller\": {\"kind\": \"feed_forward\", \"rate_hz\": 100",
                     "\"controller\": {\"kind\": \"feed_forward\", \"rate_hz\": 200")
                   .refusal(simulate + bus),
               ContainsSubstring("expected the rate of the loop, 200 Hz, found 100"));
    CHECK_THAT(bench.refusal(simulate + " --bus " + data + "/can/ur5_loop.json"),
               ContainsSubstring("expected the robot's 2 joints, found 6"));
    CHECK_THAT(Bench("\"recording\": {\"rate_hz\": 100", "\"recording\": {\"rate_hz\": 80")
                   .refusal(simulate + " -o " + bench.path("out")),
               ContainsSubstring("recording.rate_hz"));
    bench.write("slow.json", [] {
        std::string text = file_content(data + "/can/small_arm_loop.json");
        const std::string rate = "\"bit_rate\": 1000000";
        return text.replace(text.find(rate), rate.size(), "\"bit_rate\": 10000");
    }());
    CHECK_THAT(bench.refusal(simulate + " --bus " + bench.path("slow.json")),
               ContainsSubstring("bit_rate: expected a bus that carries"));
    bench.write("broken.json", "{");
    CHECK_THAT(bench.refusal(simulate + " --model " + bench.path("broken.json")),
               ContainsSubstring("broken.json"));
    CHECK_THAT(bench.refusal(simulate + " --bus " + bench.path("broken.json")),
               ContainsSubstring("broken.json"));
    bench.write("file", "");
    CHECK_THAT(bench.refusal(simulate + " -o " + bench.path("file")), ContainsSubstring("file"));
}

} // namespace loop_commands_test
