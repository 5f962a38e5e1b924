// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/support/name_literals.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <string>

namespace peer_names_test {

using namespace dfdyn::tests;

/// The libraries that a file of `tools/bench/peers` compares with.
std::set<std::string> libraries() {
    const std::string ending = "_peers";
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(project / "tools/bench/peers")) {
        const std::string stem = entry.path().stem().string();
        if (stem.ends_with(ending)) {
            names.insert(stem.substr(0, stem.size() - ending.size()));
        }
    }
    return names;
}

std::string lower_case(std::string text) {
    std::ranges::transform(text, text.begin(),
                           [](unsigned char character) { return std::tolower(character); });
    return text;
}

/// The libraries whose names a literal of the file contains, in capitals or not.
std::set<std::string> named_in(const std::filesystem::path& file, const std::set<std::string>& names) {
    std::set<std::string> found;
    for (const std::string& literal : string_literals(dfdyn::tools::read_file(file))) {
        for (const std::string& name : names) {
            if (lower_case(literal).find(name) != std::string::npos) {
                found.insert(name);
            }
        }
    }
    return found;
}

TEST_CASE("the name of a library to compare with is a literal only in its own file") {
    std::set<std::string> names = libraries();
    REQUIRE(names.size() >= 4);
    REQUIRE(names.erase("eigen") == 1); // the program itself is built with it, and says so
    std::set<std::string> seen;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(project / "tools")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".cpp" && extension != ".hpp") {
            continue;
        }
        for (const std::string& name : named_in(entry.path(), names)) {
            CAPTURE(entry.path(), name);
            CHECK(entry.path().filename() == name + "_peers.cpp");
            seen.insert(name);
        }
    }
    CHECK(seen == names);
}

} // namespace peer_names_test
