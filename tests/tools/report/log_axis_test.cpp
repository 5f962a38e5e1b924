// SPDX-License-Identifier: Apache-2.0
#include "tools/report/axis.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <limits>

namespace log_axis_test {

namespace tools = dfdyn::tools;

std::vector<std::string> labels_of(const tools::LogAxis& axis) {
    std::vector<std::string> labels;
    for (const tools::AxisTick& tick : tools::ticks_of(axis)) {
        if (!tick.label.empty()) {
            labels.push_back(tick.label);
        }
    }
    return labels;
}

TEST_CASE("an axis ends at round numbers around its values") {
    const tools::LogAxis axis = tools::log_axis({0.03, 7, 0.5}, 0, 1);
    CHECK(axis.low == Approx(0.02));
    CHECK(axis.high == Approx(10));
    const tools::LogAxis round = tools::log_axis({0.1, 1000}, 0, 1);
    CHECK(round.low == Approx(0.1));
    CHECK(round.high == Approx(1000));
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> exponent(-12, 12);
    for (int trial = 0; trial < 300; ++trial) {
        const double a = std::pow(10, exponent(engine));
        const double b = std::pow(10, exponent(engine));
        const tools::LogAxis random = tools::log_axis({a, b}, 0, 1);
        CHECK(random.low <= std::min(a, b) * (1 + 1e-8));
        CHECK(random.low > std::min(a, b) / 3);
        CHECK(random.high >= std::max(a, b) * (1 - 1e-8));
        CHECK(random.high < std::max(a, b) * 3);
    }
}

TEST_CASE("values that a logarithmic axis cannot show do not extend it") {
    const double infinite = std::numeric_limits<double>::infinity();
    const tools::LogAxis axis = tools::log_axis({0, -1, std::nan(""), infinite, 2, 4}, 0, 1);
    CHECK(axis.low == Approx(2));
    CHECK(axis.high == Approx(5));
    CHECK(tools::log_axis({}, 0, 1).low < tools::log_axis({}, 0, 1).high);
    CHECK(tools::log_axis({1}, 0, 1).low < tools::log_axis({1}, 0, 1).high);
}

TEST_CASE("equal ratios have equal distances and all values stay within the axis") {
    const tools::LogAxis axis{0.1, 10, 300, 100};
    CHECK(axis.pixel(0.1) == 300);
    CHECK(axis.pixel(1) == Approx(200));
    CHECK(axis.pixel(10) == Approx(100));
    CHECK(axis.pixel(1e9) == Approx(100));
    CHECK(axis.pixel(0) == 300);
    CHECK(axis.pixel(-1) == 300);
}

TEST_CASE("powers of ten are labelled and 2 and 5 as well if there is room") {
    CHECK(labels_of({0.1, 100, 0, 1}) == std::vector<std::string>{"0.1", "1", "10", "100"});
    CHECK(labels_of({0.02, 1, 0, 1}) == std::vector<std::string>{"0.02", "0.05", "0.1", "0.2", "0.5", "1"});
    CHECK(labels_of({1e-6, 1e-3, 0, 1}).front() == "10<tspan dy=\"-5\" font-size=\"9\">-6</tspan>");
    CHECK(labels_of({1e-10, 1e10, 0, 1}).size() == 11);
    CHECK(tools::ticks_of(tools::LogAxis{1, 10, 0, 1}).size() == 10);
}

} // namespace log_axis_test
