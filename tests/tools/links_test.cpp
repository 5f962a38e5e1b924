// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/project.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

using dfdyn::tests::project;

std::vector<std::filesystem::path> documents() {
    std::vector<std::filesystem::path> files{project / "README.md", project / "CONTRIBUTING.md",
                                             project / "CHANGELOG.md"};
    for (const auto& entry : std::filesystem::recursive_directory_iterator(project / "docs")) {
        if (entry.path().extension() == ".md") {
            files.push_back(entry.path());
        }
    }
    return files;
}

/// The first groups of all matches in a document.
std::vector<std::string> matches(const std::filesystem::path& document, const std::regex& pattern) {
    const std::string text = dfdyn::tools::read_file(document);
    std::vector<std::string> found;
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) {
        found.push_back((*at)[1]);
    }
    return found;
}

/// The files that a document in Markdown links to, as written there, without anchors and web addresses.
std::vector<std::string> links_of(const std::filesystem::path& document) {
    std::vector<std::string> links = matches(document, std::regex(R"(\]\(([^)#\s]+))"));
    std::erase_if(links, [](const std::string& link) { return link.find("://") != std::string::npos; });
    return links;
}

/// The paths of all C++ files, from the project's folder, each with a leading slash.
std::vector<std::string> source_paths() {
    std::vector<std::string> paths;
    for (const char* const part : {"firmware_lib", "hal", "tools", "examples", "tests", "zephyr"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(project / part)) {
            if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") {
                paths.push_back("/" + std::filesystem::relative(entry.path(), project).generic_string());
            }
        }
    }
    return paths;
}

} // namespace

TEST_CASE("every link of the documentation leads to a file") {
    std::size_t links = 0;
    for (const std::filesystem::path& document : documents()) {
        CAPTURE(document);
        for (const std::string& link : links_of(document)) {
            CAPTURE(link);
            CHECK(std::filesystem::exists(document.parent_path() / link));
            ++links;
        }
    }
    CHECK(links > 100);
}

TEST_CASE("every source file that the documentation names exists") {
    const std::vector<std::string> paths = source_paths();
    const std::regex source(R"(`([\w/.-]+\.[ch]pp)`)"); // the last parts of a path, or all of it
    const std::set<std::string> elsewhere{"include/robot_model.hpp", "robot_model.hpp", // what `start` writes
                                          "dm_motor_control.cpp"};                      // a manufacturer's
    std::size_t named = 0;
    for (const std::filesystem::path& document : documents()) {
        if (document.filename() == "CHANGELOG.md") {
            continue; // also names removed files
        }
        CAPTURE(document);
        for (const std::string& name : matches(document, source)) {
            CAPTURE(name);
            const auto is_named = [&](const std::string& path) { return path.ends_with("/" + name); };
            CHECK((elsewhere.contains(name) || std::ranges::any_of(paths, is_named)));
            ++named;
        }
    }
    CHECK(named > 100);
}
