// SPDX-License-Identifier: Apache-2.0
#include "tools/start/project.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/support/small_model.hpp"

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace project_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::file_content;
using dfdyn::tests::TemporaryDirectory;

/// `rows` samples, 4 ms apart, of two moving joints and a wrench. A window of small_model() has five.
Recording moving_arm(int rows) {
    Recording recording;
    recording.source = "run.csv";
    recording.position.names = joint_names("q", 2);
    recording.output.names = output_names(OutputKind::wrench, 2);
    for (int row = 0; row < rows; ++row) {
        const double t = 0.004 * row;
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::int64_t{4'000'000} * row);
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        recording.position.values.insert(recording.position.values.end(), {std::sin(3 * t), std::cos(5 * t)});
        for (int k = 0; k < 6; ++k) {
            recording.output.values.push_back(std::sin(3 * t) * k + std::cos(5 * t));
        }
    }
    return recording;
}

FolderContent project_of(const std::vector<Recording>& recordings) {
    std::mt19937_64 engine(1);
    return project_files(dfdyn::tests::small_model(engine, InputKind::DFR), recordings);
}

std::size_t occurrences(const std::string& text, const std::string& wanted) {
    std::size_t count = 0;
    for (std::size_t at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) {
        ++count;
    }
    return count;
}

TEST_CASE("a project has the rows of the longest recording and expects its last prediction") {
    const FolderContent files = project_of({moving_arm(3), moving_arm(40), moving_arm(20)});
    const std::string& ticks = files.at("src/recorded_ticks.hpp");
    CHECK(occurrences(ticks, "\n    {") == 40);
    CHECK(ticks.find("expected_prediction[robot_model::Model::outputs] = {0, 0") == std::string::npos);
}

TEST_CASE("a project that predicts nothing says so and shows no error") {
    const TemporaryDirectory directory;
    const std::string folder = directory.path() / "controller";
    write_folder(folder, project_of({moving_arm(3)}));
    const std::string program = directory.path() / "replay_ticks";
    const std::string output = directory.path() / "out.txt";
    const std::string compile = std::string(DFDYN_CXX) + " -std=c++20 -I " + folder + "/include " + folder +
                                "/src/main.cpp -o " + program;
    REQUIRE(std::system(compile.c_str()) == 0);
    CHECK(std::system((program + " > " + output).c_str()) != 0);
    const std::string text = file_content(output);
    CHECK_THAT(text, ContainsSubstring("nothing was predicted"));
    CHECK(text.find("nan") == std::string::npos);
}

} // namespace project_test
