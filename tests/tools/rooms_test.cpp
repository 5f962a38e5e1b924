// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/project.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

using dfdyn::tests::project;

/// The level of each room of `tools/`, from the table of docs/architecture.md.
std::map<std::string, int> documented_levels() {
    const std::string text = dfdyn::tools::read_file(project / "docs/architecture.md");
    std::map<std::string, int> levels;
    const std::string rule = "| level | rooms |\n| --- | --- |\n";
    const std::size_t first = text.find(rule) + rule.size();
    const std::string table = text.substr(first, text.find("\n\n", first) - first);
    const std::regex row(R"(\| (\d) \| (.*) \|)");
    const std::regex room(R"(`(\w+)` \()");
    for (std::sregex_iterator at(table.begin(), table.end(), row), end; at != end; ++at) {
        const std::string rooms = (*at)[2];
        for (std::sregex_iterator name(rooms.begin(), rooms.end(), room); name != end; ++name) {
            levels[(*name)[1]] = std::stoi((*at)[1]);
        }
    }
    return levels;
}

std::set<std::string> folders_of(const std::filesystem::path& parent) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(parent)) {
        if (entry.is_directory()) {
            names.insert(entry.path().filename().string());
        }
    }
    return names;
}

/// The first group of every match of `include` in the sources of `folder`.
std::set<std::string> included_names(const std::filesystem::path& folder, const std::regex& include) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") {
            const std::string text = dfdyn::tools::read_file(entry.path());
            for (std::sregex_iterator at(text.begin(), text.end(), include), end; at != end; ++at) {
                names.insert((*at)[1]);
            }
        }
    }
    return names;
}

/// The rooms that the sources of `folder` include.
std::set<std::string> included_rooms(const std::filesystem::path& folder) {
    return included_names(folder, std::regex(R"(#include "tools/(\w+)/)"));
}

} // namespace

TEST_CASE("a room of the program includes only rooms of lower levels, as documented") {
    const std::map<std::string, int> levels = documented_levels();
    for (const std::string& room : folders_of(project / "tools")) {
        CAPTURE(room);
        REQUIRE(levels.contains(room));
        for (const std::string& included : included_rooms(project / "tools" / room)) {
            CAPTURE(included);
            REQUIRE(levels.contains(included));
            CHECK((included == room || levels.at(included) < levels.at(room)));
        }
    }
    CHECK(levels.size() == folders_of(project / "tools").size());
}

TEST_CASE("a step of training includes only earlier steps and the options") {
    const std::vector<std::string> steps{"data", "physics", "likelihood", "search", "start"};
    CHECK(folders_of(project / "tools/training") == std::set<std::string>(steps.begin(), steps.end()));
    const std::regex include(R"(#include "tools/training/(\w+)[/.])");
    std::set<std::string> allowed{"training_options", "training_progress"};
    for (const std::string& step : steps) {
        CAPTURE(step);
        allowed.insert(step);
        for (const std::string& included : included_names(project / "tools/training" / step, include)) {
            CAPTURE(included);
            CHECK(allowed.contains(included));
        }
    }
}

TEST_CASE("the libraries include nothing of the program, and the firmware nothing of the bus layer") {
    for (const char* const folder : {"firmware_lib", "hal"}) {
        CAPTURE(folder);
        CHECK(included_rooms(project / folder).empty());
    }
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(project / "firmware_lib/include")) {
        if (entry.is_regular_file()) {
            CAPTURE(entry.path());
            CHECK(dfdyn::tools::read_file(entry.path()).find("dfdyn/hal/") == std::string::npos);
        }
    }
}

TEST_CASE("a folder of the program or of the tests has at most a dozen chapters, catalogues apart") {
    const std::set<std::filesystem::path> catalogues{"tools/can/families",      "tools/commands",
                                                     "tools/diagnosis/effects", "tools/simulation/faults",
                                                     "tests/hal/device",        "tests/hal/families"};
    const std::set<std::filesystem::path> too_many{"tests/hal/campaign"}; // may only shrink
    std::map<std::filesystem::path, std::set<std::string>> chapters;      // a header and its source are one
    for (const char* const part : {"tools", "tests"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(project / part)) {
            if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") {
                chapters[std::filesystem::relative(entry.path().parent_path(), project)].insert(
                    entry.path().stem().string());
            }
        }
    }
    for (const auto& [folder, names] : chapters) {
        CAPTURE(folder);
        CHECK((names.size() <= 12 || catalogues.contains(folder) || too_many.contains(folder)));
    }
    for (const std::filesystem::path& folder : too_many) {
        CAPTURE(folder);
        CHECK(chapters[folder].size() > 12);
    }
}

TEST_CASE("a source file has at most 350 lines, generated ones apart") {
    const std::set<std::filesystem::path> generated{"examples/ur5/ur5_model.hpp"};
    constexpr std::ptrdiff_t most_lines = 350;
    for (const char* const part : {"firmware_lib", "hal", "tools", "examples", "tests"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(project / part)) {
            const std::filesystem::path file = std::filesystem::relative(entry.path(), project);
            if ((file.extension() != ".cpp" && file.extension() != ".hpp") || generated.contains(file)) {
                continue;
            }
            const std::string text = dfdyn::tools::read_file(entry.path());
            CAPTURE(file);
            CHECK(std::ranges::count(text, '\n') <= most_lines);
        }
    }
}
