// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/minimise.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <stdexcept>

namespace minimise_test {

namespace tools = dfdyn::tools;
using Eigen::VectorXd;

/// Rosenbrock's function with its minimum of 0 at (1, 1).
std::optional<tools::PointValue> valley(const VectorXd& x) {
    const double across = x[1] - x[0] * x[0];
    return tools::PointValue{(1 - x[0]) * (1 - x[0]) + 100 * across * across,
                             VectorXd{{-2 * (1 - x[0]) - 400 * across * x[0], 200 * across}}};
}

tools::Bounds box(double lower, double upper) {
    return {VectorXd::Constant(2, lower), VectorXd::Constant(2, upper)};
}

const VectorXd start{{-1.2, 1.0}};

TEST_CASE("minimise finds the minimum and is deterministic") {
    const tools::Minimum minimum = tools::minimise(valley, box(-5, 5), start, 1e-12, 500);
    CHECK(minimum.point[0] == Approx(1).margin(1e-4));
    CHECK(minimum.point[1] == Approx(1).margin(1e-4));
    CHECK(minimum.evaluations < 200);
    const tools::Minimum again = tools::minimise(valley, box(-5, 5), start, 1e-12, 500);
    CHECK(minimum.point == again.point);
    CHECK(minimum.evaluations == again.evaluations);
}

TEST_CASE("minimise stays within the bounds") {
    const tools::Minimum minimum = tools::minimise(valley, box(-5, 0.5), VectorXd{{-9, 9}}, 1e-12, 500);
    CHECK(minimum.point[0] == Approx(0.5)); // the constrained minimum on the bound
    CHECK(minimum.point[1] == Approx(0.25).margin(1e-4));
}

TEST_CASE("minimise stops after its number of evaluations and keeps the best point") {
    const tools::Minimum minimum = tools::minimise(valley, box(-5, 5), start, 1e-12, 10);
    CHECK(minimum.evaluations <= 10);
    CHECK(minimum.value < valley(start)->value);
    CHECK(minimum.value == valley(minimum.point)->value);
}

TEST_CASE("minimise continues past points without a value") {
    const auto holed = [](const VectorXd& x) { return x[0] > 1.2 || x[0] < -2 ? std::nullopt : valley(x); };
    const tools::Minimum minimum = tools::minimise(holed, box(-500, 500), start, 1e-12, 500);
    CHECK(minimum.value < 1e-6);
}

TEST_CASE("minimise reports that there is no value at all") {
    const auto nothing = [](const VectorXd&) -> std::optional<tools::PointValue> { return std::nullopt; };
    const tools::Minimum minimum = tools::minimise(nothing, box(-5, 5), start, 1e-6, 50);
    CHECK(std::isinf(minimum.value));
    CHECK(minimum.point.size() == 0);
    CHECK(minimum.evaluations >= 1);
}

TEST_CASE("minimise passes on exceptions of the function") {
    int calls = 0;
    const auto throwing = [&calls](const VectorXd& x) {
        if (++calls == 3) {
            throw std::logic_error("third call");
        }
        return valley(x);
    };
    CHECK_THROWS_AS(tools::minimise(throwing, box(-5, 5), start, 1e-12, 500), std::logic_error);
    CHECK(calls == 3);
}

} // namespace minimise_test
