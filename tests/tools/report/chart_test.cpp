// SPDX-License-Identifier: Apache-2.0
#include "tools/report/chart.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/balanced_markup.hpp"

#include <cmath>
#include <limits>
#include <regex>
#include <sstream>

namespace chart_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::markup_fault;

std::size_t occurrences(const std::string& text, const std::string& wanted) {
    std::size_t count = 0;
    for (std::size_t at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) {
        ++count;
    }
    return count;
}

ChartCurve curve(const std::string& name, std::vector<double> y) {
    std::vector<double> x;
    std::vector<double> low;
    std::vector<double> high;
    for (const double value : y) {
        x.push_back(static_cast<double>(x.size()) + 1);
        low.push_back(0.5 * value);
        high.push_back(2 * value);
    }
    return {name, std::move(x), std::move(y), low, high};
}

/// The path of the first line.
std::string line_of(const std::string& svg) {
    std::smatch match;
    REQUIRE(std::regex_search(svg, match, std::regex("<path class=\"line\" d=\"([^\"]*)\"")));
    return match[1];
}

TEST_CASE("a chart of curves shows each with its name and with points at the right places") {
    const std::string svg = curve_chart("Title", "x", "y", {curve("a", {1, 10, 100}), curve("b", {2, 3, 4})});
    CHECK(markup_fault(svg).empty());
    CHECK(occurrences(svg, "<path class=\"line\"") == 2);
    CHECK_THAT(svg, ContainsSubstring(">a</text>"));
    CHECK_THAT(svg, ContainsSubstring(">b</text>"));
    CHECK_THAT(svg, ContainsSubstring("class=\"curve c0 dash0\""));
    CHECK_THAT(svg, ContainsSubstring("class=\"curve c1 dash0\""));
    // x from 1 to 5 is at pixels 66 to 586, y from 0.5 to 200 at pixels 364 to 34.
    CHECK_THAT(line_of(svg), Catch::Matchers::StartsWith("M66.00 "));
    std::smatch match;
    const std::string line = line_of(svg);
    REQUIRE(
        std::regex_match(line, match, std::regex("M66\\.00 ([0-9.]+)L([0-9.]+) ([0-9.]+)L[0-9.]+ [0-9.]+")));
    const auto y_pixel = [](double y) { return 364 - 330 * std::log(y / 0.5) / std::log(400); };
    CHECK(std::stod(match[1]) == Approx(y_pixel(1)).margin(0.06));
    CHECK(std::stod(match[2]) == Approx(66 + 520 * std::log(2) / std::log(5)).margin(0.06));
    CHECK(std::stod(match[3]) == Approx(y_pixel(10)).margin(0.06));
}

TEST_CASE("points that a logarithmic axis cannot show interrupt the curve") {
    const double infinite = std::numeric_limits<double>::infinity();
    const std::string svg =
        curve_chart("t", "x", "y", {curve("a", {1, 2, std::nan(""), 3, 4, 0, 5, infinite, 6})});
    CHECK(markup_fault(svg).empty());
    CHECK(occurrences(line_of(svg), "M") == 4);
    CHECK(occurrences(line_of(svg), "L") == 2);
    CHECK(svg.find("nan") == std::string::npos);
    CHECK(svg.find("inf") == std::string::npos);
}

TEST_CASE("eight curves differ in colour or dashes") {
    std::vector<ChartCurve> curves;
    for (int i = 0; i < 12; ++i) {
        curves.push_back(curve(std::to_string(i), {1, 2}));
    }
    const std::string svg = curve_chart("t", "x", "y", curves);
    for (int i = 0; i < 12; ++i) {
        std::ostringstream look;
        look << "\"curve c" << i % 8 << " dash" << i / 4 << '"';
        CHECK(occurrences(svg, look.str()) == 1);
    }
}

TEST_CASE("a box chart draws boxes and only the name if there is no distribution") {
    const double none = std::nan("");
    const std::string svg = box_chart(
        "t", "y", {{"wide", 0.01, 0.1, 1, 10, 100, 3}, {"none", none, none, none, none, none, none}});
    CHECK(markup_fault(svg).empty());
    CHECK(occurrences(svg, "<rect") == 1);
    CHECK(occurrences(svg, "class=\"median\"") == 1);
    CHECK_THAT(svg, ContainsSubstring(">none</text>"));
    CHECK(svg.find("nan") == std::string::npos);
    // 0.01 to 100 spans 520 pixels to the right of the names: the median is in the middle, the box has half
    // that width.
    CHECK_THAT(svg, ContainsSubstring("width=\"260.0\" height=\"14.0\""));
    CHECK_THAT(svg, ContainsSubstring("class=\"median\" x1=\"301.6\""));
}

TEST_CASE("names are escaped and a chart without data is valid") {
    CHECK_THAT(curve_chart("<b>", "x", "y", {curve("</svg>", {1, 2})}), ContainsSubstring("&lt;/svg&gt;"));
    CHECK(markup_fault(curve_chart("<b>", "x<", "y&", {curve("</svg>", {1, 2})})).empty());
    CHECK(markup_fault(curve_chart("t", "x", "y", {})).empty());
    CHECK(markup_fault(box_chart("t", "y", {})).empty());
}

TEST_CASE("a standalone chart includes its style") {
    const std::string svg = standalone_chart(curve_chart("t", "x", "y", {curve("a", {1, 2})}));
    CHECK(markup_fault(svg).empty());
    CHECK_THAT(svg, ContainsSubstring("<style>"));
    CHECK(occurrences(svg, "class=\"paper\"") == 1);
    CHECK_THAT(svg, Catch::Matchers::StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""));
}

} // namespace chart_test
