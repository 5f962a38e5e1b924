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

/// A file that a page names, as written there, and a symbol that the page says is in it.
struct NamedSymbol {
    std::string file, symbol;
};

/// Returns the pairs of "`file` (`symbol`, `other` …)" and of "`symbol` (`file`)" in a document.
std::vector<NamedSymbol> named_symbols(const std::filesystem::path& document) {
    const std::string text = dfdyn::tools::read_file(document);
    const std::regex file_first(R"(`([\w/.-]+\.[ch]pp)` \((`[^)]*)\))");
    const std::regex symbol_first(R"(`(\w+)` \(`([\w/.-]+\.[ch]pp)`\))");
    const std::regex symbol(R"(`(\w+)`)");
    std::vector<NamedSymbol> found;
    for (std::sregex_iterator at(text.begin(), text.end(), file_first), end; at != end; ++at) {
        const std::string symbols = (*at)[2].str();
        for (std::sregex_iterator one(symbols.begin(), symbols.end(), symbol); one != end; ++one) {
            found.push_back({(*at)[1].str(), (*one)[1].str()});
        }
    }
    for (std::sregex_iterator at(text.begin(), text.end(), symbol_first), end; at != end; ++at) {
        found.push_back({(*at)[2].str(), (*at)[1].str()});
    }
    return found;
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

TEST_CASE("every symbol that the architecture page names with its file is in that file") {
    const std::vector<std::string> paths = source_paths();
    const std::vector<NamedSymbol> named = named_symbols(project / "docs/architecture.md");
    for (const NamedSymbol& one : named) {
        CAPTURE(one.file, one.symbol);
        const std::regex word("\\b" + one.symbol + "\\b");
        const auto has_symbol = [&](const std::string& path) {
            return path.ends_with("/" + one.file) &&
                   std::regex_search(dfdyn::tools::read_file(project / path.substr(1)), word);
        };
        CHECK(std::ranges::any_of(paths, has_symbol));
    }
    CHECK(named.size() > 20);
}

TEST_CASE("the index of the documentation links to every page") {
    const std::filesystem::path index = project / "docs/index.md";
    std::set<std::filesystem::path> linked{std::filesystem::weakly_canonical(index)};
    for (const std::string& link : links_of(index)) {
        linked.insert(std::filesystem::weakly_canonical(index.parent_path() / link));
    }
    for (const std::filesystem::path& document : documents()) {
        if (document.parent_path() == project) {
            continue; // the README and its neighbours
        }
        CAPTURE(document);
        CHECK(linked.contains(std::filesystem::weakly_canonical(document)));
    }
}
