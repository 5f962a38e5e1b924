// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/support/project.hpp"
#include "tools/base/system/read_file.hpp"

#include <nlohmann/json.hpp>

#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace exit_status_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::Outcome;
using dfdyn::tests::project;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string log_file = DFDYN_TEST_DATA_DIR "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv";
const std::string train =
    "train --log " + log_file +
    " --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 --rows 0:1200 ";

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream lines(text);
    std::vector<std::string> all;
    for (std::string line; std::getline(lines, line);) {
        all.push_back(line);
    }
    return all;
}

/// Returns the names of the subcommands, from the help text.
std::vector<std::string> subcommands(const TemporaryDirectory& directory) {
    const std::string help = run_program(directory, "--help").out;
    std::vector<std::string> names;
    for (const std::string& line : lines_of(help.substr(help.find("Subcommands:")))) {
        if (line.starts_with("  ") && line[2] != ' ') {
            names.push_back(line.substr(2, line.find(' ', 2) - 2));
        }
    }
    return names;
}

TEST_CASE("the page on exit statuses has each command's line of the help text") {
    const TemporaryDirectory directory;
    const std::string page = dfdyn::tools::read_file(project / "docs/reference/exit-status.md");
    const std::vector<std::string> names = subcommands(directory);
    CHECK(names.size() >= 16);
    for (const std::string& name : names) {
        CAPTURE(name);
        const std::string help = run_program(directory, name + " --help").out;
        const std::string start = "Exit status: ";
        const std::size_t at = help.find(start);
        REQUIRE(at != std::string::npos);
        const std::string status = help.substr(at + start.size(), help.find('\n', at) - at - start.size());
        CHECK_THAT(page, ContainsSubstring("| `" + name + "` | " + status + " |"));
        CHECK_THAT(help, ContainsSubstring("--quiet"));
    }
}

TEST_CASE("the reference of the commands has their help texts") {
    const TemporaryDirectory directory;
    CHECK(run_program(directory, "man --reference").out ==
          dfdyn::tools::read_file(project / "docs/reference/commands.md"));
}

TEST_CASE("commands that print figures have --json") {
    const TemporaryDirectory directory;
    const std::set<std::string> without{"simulate", "plant", "man", "completion"}; // they print no figures
    for (const std::string& name : subcommands(directory)) {
        CAPTURE(name);
        const bool has = run_program(directory, name + " --help").out.find("--json") != std::string::npos;
        CHECK(has == !without.contains(name));
    }
}

TEST_CASE("with --json a command prints one object and no text") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const Outcome trained = run_program(directory, train + "--json --quiet -o " + in + "/m.json");
    REQUIRE(trained.status == 0);
    CHECK(trained.error.empty());
    const auto training = nlohmann::json::parse(trained.out);
    CHECK(training.at("schema") == "dfdyn.training/1");
    CHECK(training.at("noise_std").size() == 6);
    CHECK(training.at("footprint").at("flash_bytes") > 0);

    const Outcome replayed =
        run_program(directory, "replay --model " + in + "/m.json --log " + log_file + " --contacts --json");
    REQUIRE(replayed.status == 0);
    const auto replay = nlohmann::json::parse(replayed.out);
    CHECK(replay.at("recordings").at(0).at("ticks") == 3470);
    CHECK(replay.at("recordings").at(0).at("nrmse").size() == 6);
    CHECK(replay.contains("contacts"));

    const Outcome footprint = run_program(directory, "footprint --model " + in + "/m.json --json");
    CHECK(nlohmann::json::parse(footprint.out).at("flash_bytes") ==
          training.at("footprint").at("flash_bytes"));

    const Outcome full =
        run_program(directory, "footprint --model " + in + "/m.json --json >/dev/full 2>" + in + "/stderr #");
    const Outcome help = run_program(directory, "train --help >/dev/full 2>" + in + "/stderr #");
    CHECK(help.status == 2);
    CHECK_THAT(help.error, Catch::Matchers::StartsWith("dfdyn: cannot write to standard output: "));
    CHECK(full.status == 2);
    CHECK(full.error == "dfdyn: cannot write to standard output: No space left on device\n");
}

TEST_CASE("buscheck --json has the figures of its text") {
    const TemporaryDirectory directory;
    const Outcome checked = run_program(
        directory, "buscheck --json --log " + std::string(DFDYN_TEST_DATA_DIR) + "/can/devices/damiao.log");
    const auto json = nlohmann::json::parse(checked.out);
    CHECK(json.at("bus").at("received") > 0);
    CHECK(json.at("bus").at("load").is_null()); // no bit rate without a description
    CHECK(json.at("sources").at(0).at("rate_hz") > 0);
    REQUIRE(json.at("recognised").size() == json.at("families").size());
    CHECK(json.at("recognised").at(0).at("boards").at(0).at("positions_hz") > 0);
}

TEST_CASE("a recording may come from a pipe of the shell") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    const std::string piped =
        "--version; cat " + std::string(log_file) + " | " + DFDYN_PROGRAM +
        " train --log /dev/stdin --outputs i --features 20 --starts 1 --likelihood-rows 60 "
        "--lags 4 --rows 0:1200 --quiet -o " +
        in + "/m.json";
    CHECK(run_program(directory, piped).status == 0);
}

TEST_CASE("a budget has the usual units") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    REQUIRE(run_program(directory, train + "-o " + in + "/m.json").status == 0);
    for (const std::string budget : {"1M", "1Mi", "1MiB", "1024K", "1024Ki", "1048576"}) {
        CAPTURE(budget);
        CHECK(run_program(directory, "footprint --model " + in + "/m.json --flash " + budget).status == 0);
    }
    const Outcome beyond = run_program(directory, "footprint --model " + in + "/m.json --flash 2K");
    CHECK(beyond.status == 1);
    CHECK_THAT(beyond.error,
               Catch::Matchers::StartsWith("dfdyn: " + in +
                                           "/m.json: beyond the budget: flash: expected at most "
                                           "2 KiB, found ") &&
                   Catch::Matchers::EndsWith(" KiB\n"));
}

TEST_CASE("with --quiet a command keeps warnings and errors, and drops notes") {
    const TemporaryDirectory directory;
    const std::string in = directory.path().string();
    CHECK_THAT(run_program(directory, train + "-o " + in + "/m.json").error, ContainsSubstring("not used"));
    CHECK_THAT(run_program(directory, train + "--prior unit -o " + in + "/m.json").error,
               ContainsSubstring("--prior is ignored"));
    CHECK(run_program(directory, train + "--quiet --prior unit -o " + in + "/m.json").error.empty());
    const std::string torn =
        directory.write("torn.log", "(1.000000) can0 281#0102\n(1.001000) can0 28").string();
    CHECK_THAT(run_program(directory, "buscheck --quiet --log " + torn).error,
               ContainsSubstring("warning: ") && ContainsSubstring(" is torn and left out"));
    directory.write("bad.csv", "t,q1,i1\n0,1,2\n0,1,2\n");
    CHECK_THAT(
        run_program(directory, "train --quiet --log " + in + "/bad.csv --outputs i -o " + in + "/x").error,
        ContainsSubstring("bad.csv:3: column t: expected"));
}

} // namespace exit_status_test
