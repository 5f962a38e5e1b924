// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/wait.h>

namespace output_files_test {

namespace fs = std::filesystem;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string data = DFDYN_TEST_DATA_DIR;
const std::string log = data + "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv";
const std::string small_arm = " --robot " + data + "/robots/small_arm/small_arm.urdf";
const std::string quick_training =
    "train --log " + log +
    " --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 --rows 0:1200";

std::map<std::string, std::string> state_of(const fs::path& folder) {
    std::map<std::string, std::string> state;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        state[entry.path().string()] = entry.is_directory() ? "" : file_content(entry.path());
    }
    return state;
}

/// Runs `PREFIX dfdyn ARGUMENTS` in the folder `working`.
Outcome run_after(const std::string& prefix, const TemporaryDirectory& directory,
                  const std::string& arguments, const fs::path& working) {
    const std::string error = directory.path() / "stderr";
    const int status = std::system(("cd " + working.string() + " && " + prefix + " " + DFDYN_PROGRAM + " " +
                                    arguments + " >/dev/null 2>" + error)
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", file_content(error)};
}

TEST_CASE("a command whose last file does not fit on the disk leaves no files") {
    const TemporaryDirectory results;
    const TemporaryDirectory directory;
    results.write("earlier.hpp", "earlier");
    REQUIRE(run_program(directory, quick_training + " -o model.json", results.path()).status == 0);
    const auto before = state_of(results.path());
    const std::string arm = small_arm + " --scenario " + data + "/scenarios/";
    // blocks of 512 bytes: each command has files that are smaller and files that are larger
    const auto [blocks, arguments] = GENERATE_COPY(table<int, std::string>(
        {{40, quick_training + " -o new.json --header earlier.hpp"},
         {200, "replay --model model.json --log " + log + " --contact-list c.json --report r.html"},
         {1500,
          "replay --model model.json --log " + log + " --contact-list c.json --report r.html -o out.csv"},
         {300, "simulate" + arm + "small_arm.json -o run.csv --truth truth.csv"},
         {30, "loop --simulate --duration 6" + arm + "small_arm_loop.json -o folder/in/folder"},
         {8, "man -o pages"}}));
    CAPTURE(arguments);
    const Outcome outcome =
        run_after("ulimit -f " + std::to_string(blocks) + " &&", directory, arguments, results.path());
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.error, ContainsSubstring(": cannot write: File too large\n"));
    CHECK(state_of(results.path()) == before);
    CHECK(run_program(directory, arguments, results.path()).status == 0); // with room it succeeds
}

TEST_CASE("a command interrupted by Ctrl-C leaves no files") {
    const TemporaryDirectory results;
    const TemporaryDirectory directory;
    nlohmann::json scenario = nlohmann::json::parse(file_content(data + "/scenarios/small_arm.json"));
    scenario["recording"]["samples"] = 100'000'000;
    results.write("endless.json", scenario.dump());
    const auto before = state_of(results.path());
    const std::string arguments = GENERATE(std::string(" -o run.csv"), " -o run.csv --truth truth.csv");
    const Outcome outcome =
        run_after("timeout -s INT 0.3", directory,
                  "simulate" + small_arm + " --scenario endless.json" + arguments, results.path());
    CHECK(outcome.status == 124); // of `timeout`
    CHECK(state_of(results.path()) == before);
}

TEST_CASE("a thinned report has a separate file of all ticks and a complete report has none") {
    const TemporaryDirectory results;
    const TemporaryDirectory directory;
    REQUIRE(run_program(directory, quick_training + " -o model.json", results.path()).status == 0);
    const std::string replay = "replay --model model.json --horizon 0 --log " + log;
    REQUIRE(run_program(directory, replay + " --report r.html", results.path()).status == 0);
    CHECK_FALSE(fs::exists(results.path() / "r.ticks.csv"));
    std::string many = replay;
    for (int copy = 0; copy < 20; ++copy) { // 20 x 3470 ticks
        many += "," + log;
    }
    REQUIRE(run_program(directory, many + " --report r.html", results.path()).status == 0);
    CHECK_THAT(file_content(results.path() / "r.html"),
               ContainsSubstring("ticks are in <a href=\"./r.ticks.csv\">r.ticks.csv</a>"));
    const std::string ticks = file_content(results.path() / "r.ticks.csv");
    CHECK(std::count(ticks.begin(), ticks.end(), '\n') > 60'000);
    REQUIRE(run_program(directory, replay + " --report r.html", results.path()).status == 0);
    CHECK_FALSE(fs::exists(results.path() / "r.ticks.csv")); // of the earlier page
    REQUIRE(run_program(directory, many + " --report ./r.html -o all.csv", results.path()).status == 0);
    CHECK_THAT(file_content(results.path() / "r.html"), ContainsSubstring("href=\"./all.csv\""));
    CHECK_FALSE(fs::exists(results.path() / "r.ticks.csv"));
    CHECK(file_content(results.path() / "all.csv") == ticks);
    fs::create_directory(results.path() / "r.ticks.csv");
    CHECK(run_program(directory, replay + " --report r.html", results.path()).status == 0);
    CHECK(run_program(directory, many + " --report r.html", results.path()).status == 2);
    CHECK(fs::is_directory(results.path() / "r.ticks.csv"));
}

TEST_CASE("two outputs to the same file are refused under any names") {
    const TemporaryDirectory results;
    const TemporaryDirectory directory;
    const Outcome outcome = run_program(directory,
                                        "simulate" + small_arm + " --scenario " + data +
                                            "/scenarios/small_arm.json -o run.csv --truth ./run.csv",
                                        results.path());
    CHECK(outcome.status == 2);
    CHECK_THAT(outcome.error, ContainsSubstring("expected a file of its own"));
    CHECK(fs::is_empty(results.path()));
}

TEST_CASE("a command writes files of any ending") {
    const TemporaryDirectory results;
    const TemporaryDirectory directory;
    CHECK(run_program(directory,
                      "simulate" + small_arm + " --scenario " + data +
                          "/scenarios/small_arm.json -o run.json --truth truth.html",
                      results.path())
              .status == 0);
    CHECK(fs::exists(results.path() / "run.json"));
    CHECK(fs::exists(results.path() / "truth.html"));
}

} // namespace output_files_test
