// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

namespace command_line_test {

using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

long line_count(const std::string& text) { return std::ranges::count(text, '\n'); }

/// Returns the lines that begin with "note: ".
std::string notes(const std::string& text) {
    std::istringstream lines(text);
    std::string result;
    for (std::string line; std::getline(lines, line);) {
        if (line.rfind("note: ", 0) == 0) {
            result += line + '\n';
        }
    }
    return result;
}

const std::string log_file = DFDYN_TEST_DATA_DIR "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv";
const std::string quick =
    " --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 --rows 0:1200 ";

TEST_CASE("wrong usage and bad input end with status 2 and one line") {
    const TemporaryDirectory directory;
    directory.write("bad.csv", "t,q1,i1\n0,1,2\n0,1,2\n");
    directory.write("bad.json", "{\"schema\": \"dfdyn.model/9\"}");
    const std::string in = directory.path().string();
    const std::string cases[] = {
        "",
        "fly",
        "train",
        "train --log none.csv --outputs i -o x.json",
        "train --log " + in + "/bad.csv --outputs i -o " + in + "/x.json",
        "train --log " + log_file + " --outputs wind -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --input DFX -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --model XP -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --rows 9:3 -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --lags 0 -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --features 0 -o " + in + "/x.json",
        "train --log " + log_file + " --outputs i --forgetting 1.5 -o " + in + "/x.json",
        "replay --model " + in + "/bad.json --log " + log_file,
        "simulate --scenario none.json -o " + in + "/x.json",
        "simulate --robot none.urdf --scenario " + in + "/bad.json -o " + in + "/x.json",
        "replay --model none.json --log " + log_file,
        "play --log none.log --can no_such_can",
        "play --log " + log_file + " --can no_such_can",
        "play --log " + log_file + " --can no_such_can --rate 0",
    };
    for (const std::string& arguments : cases) {
        CAPTURE(arguments);
        const Outcome outcome = run_program(directory, arguments);
        CHECK(outcome.status == 2);
        CHECK(outcome.out.empty());
        CHECK_THAT(outcome.error, Catch::Matchers::ContainsSubstring("dfdyn: "));
        CHECK(line_count(outcome.error.substr(outcome.error.find("dfdyn: "))) == 1);
        CHECK_FALSE(std::filesystem::exists(directory.path() / "x.json"));
    }
}

TEST_CASE("train and replay work for every input and repeat byte for byte") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string model_and_header = "/a.json --header " + in + "/a.hpp";
    for (const std::string input : {"STD", "DF", "DFW", "DFR", "DFSR"}) {
        CAPTURE(input);
        std::string train = "train --log ";
        train.append(log_file).append(quick).append("--input ").append(input).append(" -o ").append(in);
        const Outcome trained = run_program(directory, train + model_and_header);
        CAPTURE(trained.error);
        REQUIRE(trained.status == 0);
        REQUIRE(run_program(directory, train + "/b.json").status == 0);
        CHECK(file_content(directory.path() / "a.json") == file_content(directory.path() / "b.json"));
        CHECK_FALSE(file_content(directory.path() / "a.hpp").empty());
        std::string replay = "replay --model ";
        replay.append(in).append("/a.json --log ").append(log_file).append(" --rows 1200: -o ").append(in);
        replay.append("/r.csv --report ").append(in).append("/r.html");
        const Outcome replayed = run_program(directory, replay);
        CAPTURE(replayed.error);
        REQUIRE(replayed.status == 0);
        CHECK_THAT(replayed.out, Catch::Matchers::ContainsSubstring("nRMSE, second half"));
        CHECK(line_count(file_content(directory.path() / "r.csv")) == 1 + 3470 - 1200);
        CHECK_THAT(file_content(directory.path() / "r.html"), Catch::Matchers::ContainsSubstring("</html>"));
    }
}

TEST_CASE("train reports the options that it ignores and continues") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string train = "train --log " + log_file + quick + "-o " + in + "/m.json ";
    CHECK(notes(run_program(directory, train).error).empty());
    const Outcome nonparametric =
        run_program(directory, train + "--effects viscous_friction --prior unit --shared-motion "
                                       "--torque-constants 1,1,1,1,1,1 --no-relevance");
    CHECK(nonparametric.status == 0);
    CHECK(line_count(notes(nonparametric.error)) == 5);
    for (const std::string option : {"--effects", "--prior", "--own-motion", "--torque-constants"}) {
        CHECK_THAT(nonparametric.error, Catch::Matchers::ContainsSubstring(
                                            "note: " + option + " is ignored: model NP does not read it\n"));
    }
    CHECK_THAT(nonparametric.error,
               Catch::Matchers::ContainsSubstring("--relevance is ignored: input DFR does not read it\n"));
    const Outcome on_a_grid =
        run_program(directory, train + "--refinement 3 --input STD --hyper CV --not-centred");
    CHECK(on_a_grid.status == 0);
    CHECK(notes(on_a_grid.error) == "note: --starts is ignored: --hyper CV does not read it\n"
                                    "note: --refinement is ignored: --hyper CV does not read it\n");
    CHECK_THAT(on_a_grid.out, Catch::Matchers::ContainsSubstring("cross validation: least error "));
    CHECK_THAT(on_a_grid.out, Catch::Matchers::ContainsSubstring("a grid of 169 points\n"));
}

TEST_CASE("train prints the results of its physics") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string train = "train --log " + log_file + quick + "--model P --input STD --robot " +
                              DFDYN_TEST_DATA_DIR "/robots/ur5/ur5_robot.urdf --tip ee_link -o " + in +
                              "/m.json ";
    const Outcome estimated = run_program(directory, train);
    CAPTURE(estimated.error);
    REQUIRE(estimated.status == 0);
    CHECK_THAT(estimated.out, Catch::Matchers::ContainsSubstring(
                                  "; each represents a determined combination of parameters\n"));
    CHECK_THAT(estimated.out, Catch::Matchers::ContainsSubstring(" (estimated)"));
    const Outcome given =
        run_program(directory, train + "--torque-constants 13,13,13,9,9,9.5 --centred --shared-motion");
    CHECK_THAT(given.out, Catch::Matchers::ContainsSubstring(
                              "torque constants (N m/A): 13 (given), 13 (given), 13 (given), 9 (given), "
                              "9 (given), 9.5 (given)\n"));
    CHECK_THAT(given.error,
               Catch::Matchers::ContainsSubstring("note: --centred is ignored: model P does not read it\n"));
    CHECK_THAT(given.error, Catch::Matchers::ContainsSubstring(
                                "note: --own-motion is ignored: input STD does not read it\n"));
}

TEST_CASE("a replay of a recording with other outputs than the model is rejected") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    REQUIRE(run_program(directory, "train --log " + log_file + quick + "-o " + in + "/m.json").status == 0);
    directory.write("torques.csv", "t,q1,q2,q3,q4,q5,q6,tau1\n0,1,1,1,1,1,1,1\n0.008,1,1,1,1,1,1,1\n");
    const Outcome outcome =
        run_program(directory, "replay --model " + in + "/m.json --log " + in + "/torques.csv");
    CHECK(outcome.status == 2);
    CHECK(line_count(outcome.error) == 1);
}

TEST_CASE("simulate writes a recording and the truth or nothing at all") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string data = DFDYN_TEST_DATA_DIR;
    std::string scenario = file_content(data + "/scenarios/icub_xy.json");
    const std::string samples = "\"samples\": 10000";
    scenario.replace(scenario.find(samples), samples.size(), "\"samples\": 25");
    directory.write("short.json", scenario);
    const std::string call = "simulate --robot " + data +
                             "/robots/icub_right_arm/icub_right_arm.urdf --scenario " + in +
                             "/short.json -o " + in + "/run.csv";
    CHECK(run_program(directory, call + " --truth " + in + "/truth.csv").status == 0);
    const std::string recording = file_content(directory.path() / "run.csv");
    CHECK(line_count(recording) == 26);
    CHECK(line_count(file_content(directory.path() / "truth.csv")) == 26);
    CHECK_THAT(recording, Catch::Matchers::StartsWith("t,q1,q2,q3,q4,qd1,") &&
                              Catch::Matchers::ContainsSubstring("qdd4,fx,fy,fz,mx,my,mz\n"));
    CHECK(run_program(directory, call + " --seed 3").status == 0);
    CHECK(file_content(directory.path() / "run.csv") != recording);

    scenario.replace(scenario.find("\"radius_m\": 0.1"), 15, "\"radius_m\": 0.9");
    directory.write("short.json", scenario);
    std::filesystem::remove(directory.path() / "run.csv");
    const Outcome outcome = run_program(directory, call);
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.error, Catch::Matchers::ContainsSubstring(" mm out of reach"));
    CHECK_FALSE(std::filesystem::exists(directory.path() / "run.csv"));
}

} // namespace command_line_test
