// SPDX-License-Identifier: Apache-2.0
#include "tools/report/xy_chart.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/balanced_markup.hpp"
#include "tools/report/axis.hpp"

#include <cmath>
#include <limits>

namespace xy_chart_test {

using namespace dfdyn::tools;
using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::markup_fault;

std::vector<std::string> labels(const LinearAxis& axis) {
    std::vector<std::string> texts;
    for (const AxisTick& tick : ticks_of(axis)) {
        texts.push_back(tick.label);
    }
    return texts;
}

TEST_CASE("a linear axis has margins and round labels") {
    const LinearAxis axis = linear_axis({-1, 1, std::nan("")}, 100, 200);
    CHECK(axis.low == Approx(-1.06));
    CHECK(axis.pixel(0) == Approx(150));
    CHECK(axis.pixel(7) == 200);
    CHECK(labels(axis) == std::vector<std::string>{"-1", "-0.5", "0", "0.5", "1"});
    CHECK(labels({0.9, 7.1}) == std::vector<std::string>{"1", "2", "3", "4", "5", "6", "7"});
    CHECK(labels({-2.4e-5, 1e-6}).size() >= 5);
    CHECK(labels({123456, 123457}).size() >= 2);
}

TEST_CASE("a linear axis of any length has four to eleven labels") {
    for (int tenths = 10; tenths <= 100; ++tenths) {
        CAPTURE(tenths);
        const std::size_t count = labels({0.95, 0.95 + 0.1 * tenths}).size();
        CHECK(count >= 4);
        CHECK(count <= 11);
    }
}

TEST_CASE("an axis of one value or none or of infinities is valid") {
    const double infinite = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& values : {std::vector<double>{}, {3}, {0, 0}, {infinite, std::nan("")}}) {
        const LinearAxis axis = linear_axis(values, 0, 1);
        CHECK(axis.low < axis.high);
        CHECK(ticks_of(axis).size() <= 12);
    }
}

TEST_CASE("a chart shows dots and bins and lines at the right places with their names") {
    XyChart chart{"Title", "x", "y"};
    chart.reference = {"measured", {0, 10}, {0, 10}};
    chart.points = {"samples", {0, 5, 10, std::nan("")}, {0, 5, 10, 1}};
    chart.bins = {"means", {2, 8}, {2, 8}, {1, 1}};
    chart.lines = {{"fit", {0, 5, 10}, {0, std::nan(""), 10}}, {"other", {0, 10}, {10, 0}}};
    const std::string svg = xy_chart(chart);
    CHECK(markup_fault(svg).empty());
    for (const char* name : {"samples", "means", "fit", "other", "measured"}) {
        CHECK_THAT(svg, ContainsSubstring(std::string(">").append(name).append("</text>")));
    }
    // x and y from -0.3 to 10.3 are at pixels 66 to 586 and 364 to 34.
    CHECK_THAT(svg, ContainsSubstring("d=\"M80.72 354.66h0M326.00 199.00h0M571.28 43.34h0\""));
    CHECK_THAT(svg, ContainsSubstring("d=\"M80.72 354.66M571.28 43.34\""));
    CHECK_THAT(svg, ContainsSubstring("class=\"mean\" d=\"M178.83 292.40h0\""));
    CHECK_THAT(svg,
               ContainsSubstring("class=\"spread\" x1=\"178.8\" y1=\"323.5\" x2=\"178.8\" y2=\"261.3\""));
    CHECK_THAT(svg, ContainsSubstring("class=\"curve c1 dash0\""));
    CHECK(svg.find("nan") == std::string::npos);
}

TEST_CASE("the marks of a chart are in a plot of their own with the ends of its axes") {
    XyChart chart{"Title", "x", "y"};
    chart.lines = {{"line", {0, 10}, {-5, 5}}};
    const std::string svg = xy_chart(chart);
    CHECK_THAT(svg, ContainsSubstring("data-scale=\"linear\" data-x=\"-0.3 10.3\" data-y=\"-5.3 5.3\""));
    CHECK_THAT(svg, ContainsSubstring("viewBox=\"66.0 34.0 520.0 330.0\">\n<path class=\"line\""));
}

TEST_CASE("texts of a linear chart are escaped and a chart without data is valid") {
    const std::string svg = xy_chart({"<b>", "x<", "y&", {}, {"</svg>", {1}, {1}}});
    CHECK(markup_fault(svg).empty());
    CHECK_THAT(svg, ContainsSubstring("&lt;/svg&gt;"));
    CHECK(markup_fault(xy_chart({"t", "x", "y"})).empty());
}

TEST_CASE("bins contain equal numbers of points and points of equal x stay together") {
    const XyBins bins = binned("b", {4, 1, 2, 3, std::nan("")}, {40, 10, 20, 30, 0}, 2);
    CHECK(bins.x == std::vector<double>{1.5, 3.5});
    CHECK(bins.mean == std::vector<double>{15, 35});
    CHECK(bins.deviation == std::vector<double>{5, 5});
    const XyBins same = binned("b", {1, 1, 1, 2}, {1, 2, 3, 9}, 3);
    CHECK(same.x == std::vector<double>{1, 2});
    CHECK(same.mean == std::vector<double>{2, 9});
    CHECK(binned("b", {}, {}, 5).x.empty());
}

} // namespace xy_chart_test
