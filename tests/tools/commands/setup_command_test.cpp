// SPDX-License-Identifier: Apache-2.0
// Common set-up mistakes from the command line: reported before any work, without output files, with an error
// status.
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/setup_check/mistakes.hpp"
#include "tools/base/text/number.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace setup_command_test {

using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using Catch::Matchers::StartsWith;
using dfdyn::tools::number_text;
using dfdyn::tools::OutputKind;
using dfdyn::tools::Recording;

const std::string robot =
    " --robot " DFDYN_TEST_DATA_DIR "/robots/ur5/ur5_robot.urdf --base base_link --tip ee_link ";
const std::string quick = " --features 12 --starts 1 --likelihood-rows 60 --refinement 0 ";

Recording right_recording() {
    return dfdyn::tools::read_recording(DFDYN_TEST_DATA_DIR
                                        "/ur5_kufieta/Movement_No5_Acc_slow_no_disturbance.csv",
                                        {.joint_count = 6, .outputs = OutputKind::motor_current});
}

std::string csv(const Recording& recording) {
    std::string text = "t";
    for (const auto* columns : {&recording.position, &recording.output}) {
        for (const std::string& name : columns->names) {
            text.append(",").append(name);
        }
    }
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        text.append("\n").append(number_text(recording.time_s[row]));
        for (const auto* columns : {&recording.position, &recording.output}) {
            for (const double value : columns->row(row)) {
                text.append(",").append(number_text(value));
            }
        }
    }
    return text + "\n";
}

/// A folder with a recording that has a mistake ("" for none), and calls of the program.
class Bench {
  public:
    explicit Bench(const std::string& mistake) {
        Recording recording = right_recording();
        for (const Mistake& one : classic_mistakes(6, OutputKind::motor_current)) {
            if (one.name == mistake) {
                one.make(recording);
            }
        }
        directory_.write("run.csv", csv(recording));
    }

    std::string path(const std::string& name) const { return directory_.path() / name; }

    Outcome train(const std::string& arguments) const {
        return run_program(directory_, "train --outputs i --log " + path("run.csv") + quick + " -o " +
                                           path("model.json") + " " + arguments);
    }

    Outcome call(const std::string& arguments) const { return run_program(directory_, arguments); }

    bool trained() const { return std::filesystem::exists(path("model.json")); }

  private:
    TemporaryDirectory directory_;
};

void check_refused(const Bench& bench, const std::string& arguments, const std::string& words) {
    CAPTURE(arguments);
    const Outcome outcome = bench.train(arguments);
    CAPTURE(outcome.error);
    CHECK(outcome.status == 1);
    CHECK(outcome.out.empty());
    CHECK_THAT(outcome.error, ContainsSubstring("dfdyn: " + bench.path("run.csv") + ": ") &&
                                  ContainsSubstring(words) && ContainsSubstring("--no-setup-check"));
    CHECK_FALSE(bench.trained());
}

TEST_CASE("train reports mistakes visible in the recording alone with their remedy before it starts") {
    const auto [mistake, words] = GENERATE(table<std::string, std::string>({
        {"positions in degrees", "looks like degrees; multiply by pi/180, or --units q=deg"},
        {"time in ms", "column t: expected seconds, found rows"},
        {"time in ms", "milliseconds; divide t by 1000, or --units t=ms"},
        {"time in µs", "microseconds; divide t by 1e6, or --units t=us"},
        {"time in ns", "nanoseconds; divide t by 1e9, or --units t=ns"},
        {"outputs in mA", "columns i1, i2, i3, i4, i5, i6: expected A, found up to"},
        {"outputs in mA", "looks like mA; divide by 1000, or --units i=mA"},
        {"one output dead", "column i2: expected values that vary, found 0 in every row"},
        {"one position wrapped", "column q2: expected a continuous angle"},
    }));
    CAPTURE(mistake);
    check_refused(Bench(mistake), "", words);
}

TEST_CASE("train reports exchanged columns and wrong signs by means of the robot for every model") {
    const auto [mistake, words] = GENERATE(table<std::string, std::string>({
        {"outputs 2 and 3 exchanged", "columns i2 and i3"},
        {"sign of one output", "i2: expected the sign of the robot's model"},
        {"positions in degrees", "looks like degrees"},
    }));
    CAPTURE(mistake);
    const Bench bench(mistake);
    check_refused(bench, robot + "--model P --effects coulomb_friction", words);
    check_refused(bench, robot + "--model NP", words);
}

TEST_CASE("nanoseconds beyond the range of the clock are reported as nanoseconds") {
    TemporaryDirectory directory;
    Recording recording = right_recording();
    std::string text = csv(recording);
    const std::string log =
        directory.write("run.csv", "t,q1,i1\n0,0,0\n8e6,0,0\n" + number_text(9.3e9) + ",0,0\n");
    const Outcome outcome =
        run_program(directory, "train --outputs i --log " + log + " -o " + (directory.path() / "m").string());
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.error, ContainsSubstring("run.csv:4: column t: ") &&
                                  ContainsSubstring("(--units t=ns if they are nanoseconds)"));
}

TEST_CASE("a recording with a mistake trains with --no-setup-check and a correct one without options") {
    const Bench wrong("outputs in mA");
    const Outcome unchecked = wrong.train("--no-setup-check");
    CAPTURE(unchecked.error);
    CHECK(unchecked.status == 0);
    CHECK_THAT(unchecked.error, !ContainsSubstring("looks like"));
    CHECK(wrong.trained());
    const Bench right("");
    const Outcome checked = right.train("");
    CAPTURE(checked.error);
    CHECK(checked.status == 0);
    CHECK_THAT(checked.error, !ContainsSubstring("warning: "));
    CHECK_THAT(checked.out, ContainsSubstring(", all rows (60 in the exact kernel)"));
    CHECK_THAT(right.call("train --help").out, ContainsSubstring("--no-setup-check"));
}

/// Runs `dfdyn diagnose` on the recording, which is refused; returns its output and its JSON.
std::pair<Outcome, nlohmann::json> diagnose(const Bench& bench, const std::string& option,
                                            const std::string& rows = ":1200") {
    Outcome outcome = bench.call("diagnose" + robot + "--outputs i --no-held-out --rows " + rows + " --log " +
                                 bench.path("run.csv") + " -o " + bench.path("out") + " " + option);
    INFO(outcome.error);
    REQUIRE(outcome.status == 1);
    return {std::move(outcome), nlohmann::json::parse(file_content(bench.path("out/diagnosis.json")))};
}

TEST_CASE("diagnose has the same check and the same option to skip it") {
    const Bench bench("outputs in mA");
    const auto [checked, refused] = diagnose(bench, "");
    CHECK_THAT(checked.error, ContainsSubstring("dfdyn: " + bench.path("run.csv") +
                                                ": columns i1, i2, i3, i4, i5, i6: expected A"));
    CHECK_THAT(checked.out, StartsWith("! columns i1, i2, i3, i4, i5, i6: expected A") &&
                                ContainsSubstring("looks like mA"));
    CHECK(refused["findings"].empty());
    CHECK(refused["refusals"][0]["code"] == "output_unit");
    CHECK_FALSE(std::filesystem::exists(bench.path("out/extended_model.json")));
    const auto [unchecked, next] = diagnose(bench, "--no-setup-check", ":200"); // reports the next reason
    CHECK_THAT(unchecked.out,
               !ContainsSubstring("looks like mA") && ContainsSubstring("a diagnosis needs at least 3 s"));
    CHECK(next["refusals"][0]["code"] == "too_little_information");
}

TEST_CASE("diagnose of several recordings names the one with a mistake") {
    const Bench right("");
    const Bench wrong("outputs in mA");
    const Outcome outcome =
        right.call("diagnose" + robot + "--outputs i --no-held-out --log " + right.path("run.csv") + ", " +
                   wrong.path("run.csv") + " -o " + right.path("out"));
    INFO(outcome.error);
    CHECK(outcome.status == 1);
    const std::string reason = wrong.path("run.csv") + ": columns i1, i2, i3, i4, i5, i6: expected A";
    CHECK_THAT(outcome.out, StartsWith("! " + reason) && !ContainsSubstring(right.path("run.csv") + ": col"));
    CHECK_THAT(outcome.error, ContainsSubstring("dfdyn: " + reason));
    CHECK_THAT(file_content(right.path("out/diagnosis.json")), ContainsSubstring(reason));
}

TEST_CASE("identify has the same check and the same option to skip it") {
    const Bench bench("positions in degrees");
    const std::string call = "identify" + robot + "--outputs tau --columns 'tau=i*' --rows :1200 --log " +
                             bench.path("run.csv") + " -o " + bench.path("p.json");
    const Outcome checked = bench.call(call);
    CHECK(checked.status == 1);
    CHECK(checked.out.empty());
    CHECK_THAT(checked.error, ContainsSubstring("dfdyn: " + bench.path("run.csv") + ": ") &&
                                  ContainsSubstring("looks like degrees"));
    CHECK_FALSE(std::filesystem::exists(bench.path("p.json")));
    CHECK(bench.call(call + " --no-setup-check").status == 0);
    CHECK(std::filesystem::exists(bench.path("p.json")));
}

TEST_CASE("diagnose reports an unusable clock even without the check") {
    const Bench bench("time in ms");
    CHECK_THAT(diagnose(bench, "").first.out, StartsWith("! column t: expected seconds"));
    const auto [outcome, json] = diagnose(bench, "--no-setup-check");
    CHECK_THAT(outcome.out, StartsWith("! rows are 8 s apart"));
    CHECK(json["refusals"][0]["code"] == "clock");
}

TEST_CASE("an output that cannot be written is rejected before the recording is read") {
    const Bench bench("");
    const std::string nowhere = bench.path("no_such_folder/out");
    for (const std::string& arguments :
         {"train --outputs i --log none.csv -o " + nowhere,
          "train --outputs i --log none.csv -o " + bench.path("m.json") + " --header " + nowhere,
          "replay --model none.json --log none.csv -o " + nowhere,
          "replay --model none.json --log none.csv --report " + nowhere}) {
        CAPTURE(arguments);
        const Outcome outcome = bench.call(arguments);
        CHECK(outcome.status == 2);
        CHECK_THAT(outcome.error, ContainsSubstring(nowhere) && !ContainsSubstring("none."));
    }
    CHECK_FALSE(std::filesystem::exists(bench.path("m.json")));
}

TEST_CASE("a replay without any prediction ends with status 1 and the reason, one of faster rows with 2") {
    const Bench bench("");
    REQUIRE(bench.train("").status == 0);
    Recording recording = right_recording();
    scale_clock(recording, 1000);
    const TemporaryDirectory directory;
    const std::string wrong = directory.write("ms.csv", csv(recording));
    const std::string replay = "replay --model " + bench.path("model.json") + " --log ";
    const Outcome nothing = bench.call(replay + wrong);
    CAPTURE(nothing.out, nothing.error);
    CHECK(nothing.status == 1);
    CHECK_THAT(nothing.error, ContainsSubstring("dfdyn: " + wrong + ": nothing was predicted: ") &&
                                  ContainsSubstring(" gap: expected 0.008 s between rows, found 8 s;") &&
                                  ContainsSubstring("check that units, sample period and columns"));
    CHECK(bench.call(replay + bench.path("run.csv")).status == 0);
    Recording fast = right_recording();
    scale_clock(fast, 0.25);
    const Outcome refused = bench.call(replay + directory.write("fast.csv", csv(fast)).string());
    CHECK(refused.status == 2);
    CHECK_THAT(refused.error, ContainsSubstring("expected a row every 0.008 s, as in the training of ") &&
                                  ContainsSubstring(", found one every 0.002 s"));
    Recording far = right_recording();
    for (double& position : far.position.values) {
        position *= 1000;
    }
    const Outcome beyond = bench.call(replay + directory.write("far.csv", csv(far)).string());
    CAPTURE(beyond.error);
    CHECK(beyond.status == 1);
    CHECK_THAT(beyond.error, ContainsSubstring(" position_out_of_range: q1: expected from -"));
    // One of two recordings is predicted.
    CHECK(bench.call(replay + bench.path("run.csv") + "," + wrong).status == 0);
}

} // namespace setup_command_test
