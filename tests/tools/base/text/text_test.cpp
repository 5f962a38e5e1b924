// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"

#include "tests/support/catch.hpp"

#include <cerrno>
#include <string>
#include <vector>

namespace tools = dfdyn::tools;

TEST_CASE("in_quotes makes any bytes printable and short") {
    CHECK(tools::in_quotes("abc") == R"("abc")");
    CHECK(tools::in_quotes("") == R"("")");
    CHECK(tools::in_quotes(std::string("a\0\x1b[2J\n\x7f\xff~", 10)) == R"("a\x00\x1b[2J\x0a\x7f\xff~")");
    CHECK(tools::in_quotes(std::string(40, 'x')) == '"' + std::string(40, 'x') + '"');
    CHECK(tools::in_quotes(std::string(41, 'x')) == '"' + std::string(40, 'x') + "...\"");
}

TEST_CASE("shown keeps a path on one line and keeps its letters") {
    CHECK(tools::shown("a/b c.csv") == "a/b c.csv");
    CHECK(tools::shown("Pr\xc3\xbc"
                       "fung\n.csv") == "Pr\xc3\xbc"
                                        "fung\\x0a.csv");
}

TEST_CASE("shell_word quotes what a shell would change") {
    CHECK(tools::shell_word("../run-2/model.json") == "../run-2/model.json");
    CHECK(tools::shell_word("") == "''");
    CHECK(tools::shell_word("my arm/$HOME") == "'my arm/$HOME'");
    CHECK(tools::shell_word("~/arm") == "'~/arm'");
    CHECK(tools::shell_word("Ann's") == R"('Ann'\''s')");
}

TEST_CASE("listed makes names printable and short") {
    CHECK(tools::listed(std::vector<std::string>{"T \xc2\xb0", std::string(41, 'x')}) ==
          "T \\xc2\\xb0, " + std::string(40, 'x') + "...");
}

TEST_CASE("listed stops after 30 names") {
    std::vector<std::string> names(30, "q");
    CHECK(tools::listed({}).empty());
    CHECK(tools::listed(std::vector<std::string>{"t", "q1"}) == "t, q1");
    CHECK(tools::listed(names).size() == 30 + 29 * 2);
    names.emplace_back("last");
    CHECK_THAT(tools::listed(names), Catch::Matchers::EndsWith("q, ... (31 in all)"));
}

TEST_CASE("trimmed removes spaces and tabs at both ends only") {
    CHECK(tools::trimmed(" \t a b\t ") == "a b");
    CHECK(tools::trimmed("a") == "a");
    CHECK(tools::trimmed(" \t").empty());
    CHECK(tools::trimmed("\na\r") == "\na\r");
}

TEST_CASE("system_error contains path and action and reason") {
    CHECK(std::string(tools::system_error("x.csv", "cannot open", ENOENT).what()) ==
          "x.csv: cannot open: No such file or directory");
}
