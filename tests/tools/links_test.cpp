// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/read_file.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/project.hpp"

#include <filesystem>
#include <regex>
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

/// The files that a document in Markdown links to, as written there, without anchors and web addresses.
std::vector<std::string> links_of(const std::filesystem::path& document) {
    const std::string text = dfdyn::tools::read_file(document);
    const std::regex link(R"(\]\(([^)#\s]+))");
    std::vector<std::string> links;
    for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
        if ((*at)[1].str().find("://") == std::string::npos) {
            links.push_back((*at)[1]);
        }
    }
    return links;
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
