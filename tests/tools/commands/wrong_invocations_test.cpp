// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace wrong_invocations_test {

namespace fs = std::filesystem;
using dfdyn::tests::file_content;
using dfdyn::tests::Outcome;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

const std::string data = DFDYN_TEST_DATA_DIR;

/// The paths that the table names in braces.
const std::map<std::string, std::string> places{
    {"{log}", data + "/ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short.csv"},
    {"{jittery}", data + "/ur5_kufieta/Movement_No3_Acc.csv"},
    {"{ur5}", data + "/robots/ur5/ur5_robot.urdf"},
    {"{icub}", data + "/robots/icub_right_arm/icub_right_arm.urdf"},
    {"{scenario}", data + "/scenarios/icub_xy.json"},
    {"{bus}", data + "/can/ur5_loop.json"},
    {"{bags}", data + "/ros2_bags"}};

std::string with_places(std::string text) {
    for (const auto& [name, place] : places) {
        for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at + place.size())) {
            text.replace(at, name.size(), place);
        }
    }
    return text;
}

/// An invocation, and its expected message.
struct Invocation {
    std::string arguments, message;
};

/// Reads the table: a line with the arguments after `$ `, and below it the message.
std::vector<Invocation> invocations() {
    std::istringstream lines(file_content(data + "/commands/wrong_invocations.txt"));
    std::vector<Invocation> all;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("$")) {
            all.push_back({with_places(line.substr(1)), ""});
        } else if (!line.empty() && !line.starts_with('#')) {
            REQUIRE((!all.empty() && all.back().message.empty()));
            all.back().message = with_places(line);
        }
    }
    return all;
}

/// Writes the files that the table names without a folder.
void write_files(const TemporaryDirectory& folder) {
    const std::map<std::string, std::string> contents{
        {"empty.csv", ""},
        {"empty.txt", ""},
        {"notes.txt", "hello world\nthis is no robot\n"},
        {"headers.csv", "t,q1,i1\n"},
        {"onerow.csv", "t,q1,i1\n0,1,2\n"},
        {"nan.csv", "t,q1,i1\n0,1,2\n0.1,nan,3\n"},
        {"inf.csv", "t,q1,i1\n0,1,2\n0.1,inf,3\n"},
        {"ragged.csv", "t,q1,i1\n0,1,2\n0.1,3\n"},
        {"back.csv", "t,q1,i1\n0,1,2\n-1,1,2\n"},
        {"broken.csv", "t,q1,i1\n0,1,2\n0.01,1 2,3\n"},
        {"text.csv", "hello world\nthis is no csv\n"},
        {"upper.csv", "t,Q1,I1\n0,1,2\n0.1,1,2\n"},
        {"noq.csv", "t,x,y\n0,1,2\n1,2,3\n"},
        {"dup.csv", "t,q1,q1,i1\n0,1,2,3\n1,1,2,3\n"},
        {"bus.log", "(1600000000.000000) can0 181#0000\n"},
        {"wrench.csv", "t,q1,q2,q3,q4,q5,q6,fx,fy,fz,mx,my,mz\n0,0,0,0,0,0,0,0,0,0,0,0,0\n"},
        {"two.csv", "t,q1,q2,i1,i2\n0,1,2,3,4\n1,2,3,4,5\n"},
        {"bad.json", "{\"schema\": \"dfdyn.model/9\"}"},
        {"trunc.json", "{\"schema\": "},
        {"arr.json", "[1,2]"},
        {"x.urdf", "<robot name=\"a\"><link name=\"b\"/></robot>"},
        {"xml.urdf", "<robot"},
        {"html.urdf", "<html></html>"},
        {"x.mcap", "\x89MCAP0\r\nabc"},
        {"bad.gz", "\x1f\x8b\x08\x01\x02\x03"}};
    for (const auto& [name, content] : contents) {
        folder.write(name, content);
    }
    fs::create_symlink("nowhere.csv", folder.path() / "dangling.csv");
    fs::create_directory(folder.path() / "dir");
    fs::create_directory(folder.path() / "full");
    folder.write("full/file", "x");
}

/// Returns every file of a folder with its content, and every subfolder.
std::map<std::string, std::string> state_of(const fs::path& folder) {
    std::map<std::string, std::string> state;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        state[entry.path().string()] = entry.is_directory() ? "" : file_content(entry.path());
    }
    return state;
}

/// Returns the last line, which contains the usage error.
std::string last_line(std::string text) {
    text = text.substr(0, text.find_last_not_of('\n') + 1);
    const auto before = text.rfind('\n');
    return before == std::string::npos ? text : text.substr(before + 1);
}

TEST_CASE("a wrong invocation reports what was expected and found and changes no file") {
    const TemporaryDirectory folder;
    const TemporaryDirectory output;
    write_files(folder);
    REQUIRE(run_program(output, "train --log " + places.at("{log}") +
                                    " --outputs i --features 20 --starts 1 --likelihood-rows 60 --lags 4 "
                                    "--rows 0:1200 -o " +
                                    (folder.path() / "m.json").string())
                .status == 0);
    const auto before = state_of(folder.path());
    const std::vector<Invocation> all = invocations();
    CHECK(all.size() >= 480);
    for (const Invocation& one : all) {
        CAPTURE(one.arguments);
        const Outcome outcome = run_program(output, one.arguments, folder.path());
        CHECK(outcome.status == 2);
        CHECK(last_line(outcome.error) == "dfdyn: " + one.message);
        CHECK(state_of(folder.path()) == before);
    }
}

} // namespace wrong_invocations_test
