// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/experiment/small_experiment.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>

namespace evaluate_command_test {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::small_plan;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tests::write_small_experiment;
using nlohmann::json;

/// Runs the plan of `directory` with output folder `out`.
Outcome evaluate(const TemporaryDirectory& directory, const std::string& options) {
    const std::string in = directory.path().string();
    return run_program(directory, "evaluate --plan " + in + "/plan.json -o " + in + "/out " + options);
}

/// Returns the number of unit files, after checking that each is complete.
std::size_t count_job_files(const TemporaryDirectory& directory) {
    std::size_t count = 0;
    if (!std::filesystem::exists(directory.path() / "out/cases")) {
        return count;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(directory.path() / "out/cases")) {
        if (entry.path().extension() == ".json") {
            ++count;
            CHECK_FALSE(json::parse(file_content(entry.path()), nullptr, false).is_discarded());
        }
    }
    return count;
}

TEST_CASE("evaluate writes its files without messages and reuses them") {
    const TemporaryDirectory directory;
    write_small_experiment(directory);
    const Outcome first = evaluate(directory, "--jobs 2");
    CAPTURE(first.error);
    CHECK(first.status == 0);
    CHECK(first.error.empty());
    CHECK_THAT(first.out, ContainsSubstring("4 of 4 cases x draws done (0 found from an earlier run)"));
    for (const std::string file : {"report.html", "results.csv", "tables.md", "findings.md"}) {
        CHECK_FALSE(file_content(directory.path() / "out" / file).empty());
    }
    CHECK_THAT(evaluate(directory, "").out, ContainsSubstring("(4 found from an earlier run)"));
    CHECK_THAT(evaluate(directory, "--fresh").out, ContainsSubstring("(0 found from an earlier run)"));
}

TEST_CASE("a case that cannot be computed gives status 1 and one line with the reason") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["draws"] = 1;
    plan["cases"][0]["rows_per_joint"] = 6; // more than the 5 positions of the window
    write_small_experiment(directory, plan);
    const Outcome outcome = evaluate(directory, "");
    CHECK(outcome.status == 1);
    CHECK_THAT(outcome.error,
               ContainsSubstring("NP-ML-DFR, draw 1: training options: expected 1 to lags + 1"));
    CHECK(std::ranges::count(outcome.error, '\n') == 1);
    CHECK_THAT(outcome.out, ContainsSubstring("1 of 2 cases x draws done"));
}

TEST_CASE("an invalid plan or a missing recording gives status 2 and one line") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["tests"][0]["log"] = "none.csv";
    write_small_experiment(directory, plan);
    const Outcome missing = evaluate(directory, "");
    CHECK(missing.status == 2);
    CHECK(std::ranges::count(missing.error, '\n') == 1);
    directory.write("plan.json", R"({"schema": 3})");
    CHECK(evaluate(directory, "").status == 2);
    CHECK(evaluate(directory, "--jobs 0").status == 2);
}

TEST_CASE("an interrupted run leaves complete files and continues from them") {
    const TemporaryDirectory directory;
    json plan = small_plan();
    plan["draws"] = 60;
    plan["defaults"]["features"] = 60;
    write_small_experiment(directory, plan);
    const std::string signal = GENERATE("TERM", "KILL");
    const std::string in = directory.path().string();
    std::ostringstream script; // ends the program after the fifth unit
    script << DFDYN_PROGRAM << " evaluate --plan " << in << "/plan.json -o " << in << "/out --jobs 2 & "
           << "until [ -e " << in << "/out/cases/NP-ML-STD/5.json ]; do sleep 0.001; done; kill -" << signal
           << " $!; wait $!";
    CHECK(std::system(script.str().c_str()) != 0);
    const std::size_t done = count_job_files(directory);
    CAPTURE(signal, done);
    CHECK(done > 0);
    CHECK(done < 120);
    const Outcome again = evaluate(directory, "--jobs 2");
    CHECK(again.status == 0);
    CHECK_THAT(again.out,
               ContainsSubstring("120 of 120 cases x draws done (" + std::to_string(done) + " found"));
    CHECK(count_job_files(directory) == 120);
}

} // namespace evaluate_command_test
