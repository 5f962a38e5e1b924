// SPDX-License-Identifier: Apache-2.0
#include "tools/report/report_table.hpp"

#include "tests/support/catch.hpp"

#include <limits>
#include <string>
#include <vector>

namespace report_table_test {

namespace tools = dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using Texts = std::vector<std::string>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST_CASE("the numbers of a column have equal decimals with three digits for a typical one") {
    CHECK(tools::format_column({0.27149, 0.0912, 1.5}) == Texts{"0.271", "0.091", "1.500"});
    CHECK(tools::format_column({93.84, 100.0, 66.61}) == Texts{"93.8", "100.0", "66.6"});
    CHECK(tools::format_column({1234.5, 987.6}) == Texts{"1234", "988"});
    CHECK(tools::format_column({-0.0512, 0.0}) == Texts{"-0.0512", "0.0000"});
}

TEST_CASE("a number that is not zero is not shown as zero") {
    CHECK(tools::format_column({0.0004, 30.0}) == Texts{"0.0004", "30.0000"});
    CHECK(tools::format_column({-0.002, 40.0, 45.0, 0.0}) == Texts{"-0.002", "40.000", "45.000", "0.000"});
    CHECK(tools::format_column({1.5e-12, 2e-10}) == Texts{"1.5e-12", "2e-10"});
}

TEST_CASE("a column of whole numbers has no decimals") {
    CHECK(tools::format_column({12.0, 15026.0, 0.0}) == Texts{"12", "15026", "0"});
    CHECK(tools::format_column({0.0}) == Texts{"0"});
}

TEST_CASE("the numbers of a column over more than five decades have three digits each") {
    CHECK(tools::format_column({1.2345e-7, 1.5, 120.0}) == Texts{"1.23e-07", "1.5", "120"});
    CHECK(tools::format_column({1e300, 2e300}) == Texts{"1e+300", "2e+300"});
}

TEST_CASE("a value that is not finite is a dash and does not affect the others") {
    CHECK(tools::format_column({not_a_number, 0.27149, infinity, -infinity}) ==
          Texts{"–", "0.271", "∞", "–"});
    CHECK(tools::format_column({not_a_number}) == Texts{"–"});
    CHECK(tools::format_column({}).empty());
}

TEST_CASE("a table aligns numbers to the right and has row headers in the first column") {
    const std::string html =
        tools::table_html({"Errors", {"Output", "nRMSE"}, {{"i1", 0.25}, {"i2", not_a_number}}, ""});
    CAPTURE(html);
    CHECK_THAT(html, ContainsSubstring("<caption>Errors</caption>"));
    CHECK_THAT(html, ContainsSubstring(
                         "<th scope=\"col\">Output</th><th scope=\"col\" class=\"number\">nRMSE</th>"));
    CHECK_THAT(html, ContainsSubstring("<tr><th scope=\"row\">i1</th><td class=\"number\">0.250</td></tr>"));
    CHECK_THAT(html, ContainsSubstring("<tr><th scope=\"row\">i2</th><td class=\"number\">–</td></tr>"));
    CHECK(html.find("figcaption") == std::string::npos);
}

TEST_CASE("a long name of a column is marked so that it has room for two lines") {
    const std::string html = tools::table_html(
        {"Errors", {"Output", "in the extended model", "errors before and after"}, {{"i1", "no", 0.25}}, ""});
    CAPTURE(html);
    CHECK_THAT(html, ContainsSubstring("<th scope=\"col\" class=\"long\">in the extended model</th>"));
    CHECK_THAT(html,
               ContainsSubstring("<th scope=\"col\" class=\"number long\">errors before and after</th>"));
}

TEST_CASE("a table escapes caption and columns and cells and note") {
    const std::string html = tools::table_html({"<1>", {"<2>"}, {{"<3>"}}, "<4>"});
    CAPTURE(html);
    for (const std::string text : {"1", "2", "3", "4"}) {
        CHECK_THAT(html, ContainsSubstring(">&lt;" + text + "&gt;<"));
    }
}

TEST_CASE("facts are escaped and wrap only between words") {
    const std::string html = tools::facts_html({{"a<b", "g++ -O3 <x>"}});
    CHECK_THAT(html, ContainsSubstring("<dt>a&lt;b</dt>"));
    CHECK_THAT(html, ContainsSubstring("<dd><span>g++</span> <span>-O3</span> <span>&lt;x&gt;</span></dd>"));
    CHECK(tools::facts_html({}).empty());
}

TEST_CASE("a table in Markdown has the same cells and escapes their markup") {
    const std::string text = tools::table_markdown(
        {"Errors", {"Output", "n|RMSE"}, {{"i_1", 0.25}, {"i*2", not_a_number}}, "a <note>"});
    CHECK(text == "**Errors**\n\n"
                  "| Output | n\\|RMSE |\n"
                  "| --- | ---: |\n"
                  "| i\\_1 | 0.250 |\n"
                  "| i\\*2 | – |\n"
                  "\na \\<note\\>\n");
}

} // namespace report_table_test
