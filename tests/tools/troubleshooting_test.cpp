// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/project.hpp"

#include <filesystem>
#include <regex>
#include <set>
#include <string>

namespace {

using dfdyn::tests::project;

/// Returns the words of a text that match, without repetition.
std::set<std::string> words_of(const std::string& text, const std::regex& form) {
    std::set<std::string> words;
    for (std::sregex_iterator at(text.begin(), text.end(), form), end; at != end; ++at) {
        words.insert((*at)[1]);
    }
    return words;
}

/// Returns the text of all sources of the product.
std::string sources() {
    std::string text;
    for (const char* const folder : {"firmware_lib", "hal", "tools"}) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(project / folder)) {
            if (entry.path().extension() == ".hpp" || entry.path().extension() == ".cpp") {
                text += dfdyn::tools::read_file(entry.path());
            }
        }
    }
    return text;
}

} // namespace

TEST_CASE("troubleshooting cites only names and options that the product has") {
    const std::string page = dfdyn::tools::read_file(project / "docs/guide/troubleshooting.md");
    auto cited = words_of(page, std::regex(R"(\b([a-z]+(?:_[a-z]+)+)\b)"));
    cited.merge(words_of(page, std::regex(R"(`(--[a-z][a-z-]+))")));
    CHECK(cited.size() > 40);
    const std::string product = sources();
    for (const std::string& name : cited) {
        CAPTURE(name);
        CHECK(product.find(name) != std::string::npos);
    }
}
