// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/commands/run_program.hpp"
#include "tests/tools/support/project.hpp"
#include "tools/base/system/read_file.hpp"

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace command_names_test {

using dfdyn::tests::Outcome;
using dfdyn::tests::project;
using dfdyn::tests::run_program;
using dfdyn::tests::TemporaryDirectory;

using NamesByFile = std::map<std::string, std::set<std::string>>;

/// The subcommands by the names of their files, `tools/commands/<name>_command.cpp`.
NamesByFile expected_names() {
    const std::string ending = "_command";
    NamesByFile names;
    for (const auto& entry : std::filesystem::directory_iterator(project / "tools/commands")) {
        const std::string stem = entry.path().stem().string();
        if (stem.ends_with(ending)) {
            names["tools/commands/" + entry.path().filename().string()] = {
                stem.substr(0, stem.size() - ending.size())};
        }
    }
    return names;
}

/// The first groups of all matches in the sources of the program, by file.
NamesByFile matches(const std::regex& pattern) {
    NamesByFile names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(project / "tools")) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") {
            continue;
        }
        const std::string text = dfdyn::tools::read_file(entry.path());
        for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) {
            names[std::filesystem::relative(entry.path(), project).generic_string()].insert((*at)[1]);
        }
    }
    return names;
}

TEST_CASE("a subcommand is added in the file of its name and selected by name nowhere") {
    CHECK(matches(std::regex(R"re(add_subcommand\(\s*"(\w+)")re")) == expected_names());
    CHECK(matches(std::regex(R"re((?:get_|got_)subcommand\(\s*"(\w+)")re")).empty());
    CHECK(matches(std::regex(R"re(get_name\(\) [=!]= "(\w+)")re")).empty());
}

TEST_CASE("help and version end with status 0 and every subcommand shows an example") {
    const TemporaryDirectory directory;
    const Outcome help = run_program(directory, "--help");
    CHECK(help.status == 0);
    CHECK_THAT(run_program(directory, "--version").out, Catch::Matchers::StartsWith("dfdyn "));
    for (const auto& [file, names] : expected_names()) {
        CAPTURE(file);
        const std::string& command = *names.begin();
        CHECK_THAT(help.out, Catch::Matchers::ContainsSubstring("\n  " + command + " "));
        const Outcome outcome = run_program(directory, command + " --help");
        CHECK(outcome.status == 0);
        CHECK(std::regex_search(outcome.out, std::regex("Examples?:\\s*\\n\\s+\\S")));
    }
}

} // namespace command_names_test
