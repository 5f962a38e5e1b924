// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/features/cos_sin.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace {

using dfdyn::cos_sin;
using dfdyn::largest_cos_sin_argument;

template <class Scalar>
constexpr double documented_error = std::is_same_v<Scalar, float> ? 1.2e-7 : 3e-16;

/// The largest absolute error of either over some arguments, against the C library in extended precision.
template <class Scalar>
double largest_error(const std::vector<Scalar>& arguments, Scalar amplitude = 1) {
    const auto count = arguments.size();
    std::vector<Scalar> cosine(count);
    std::vector<Scalar> sine(count);
    REQUIRE(cos_sin(arguments.data(), static_cast<int>(count), amplitude, cosine.data(), sine.data()));
    long double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const long double x = arguments[i];
        largest = std::max({largest, std::abs(cosine[i] - amplitude * std::cos(x)),
                            std::abs(sine[i] - amplitude * std::sin(x))});
    }
    return static_cast<double>(largest);
}

/// A few thousand neighbours, in the last place, of multiples of π/4.
template <class Scalar>
std::vector<Scalar> quadrant_borders() {
    std::vector<Scalar> arguments;
    const long double eighth = std::acos(-1.0L) / 4;
    for (int k = -10'400; k <= 10'400; ++k) {
        const auto border = static_cast<Scalar>(eighth * k);
        arguments.push_back(std::nextafter(border, Scalar(-1e9)));
        arguments.push_back(border);
        arguments.push_back(std::nextafter(border, Scalar(1e9)));
    }
    return arguments;
}

template <class Scalar>
std::vector<Scalar> random_arguments(std::mt19937_64& engine, double largest, int count) {
    std::uniform_real_distribution<double> argument(-largest, largest);
    std::vector<Scalar> arguments(static_cast<std::size_t>(count));
    std::generate(arguments.begin(), arguments.end(), [&] { return static_cast<Scalar>(argument(engine)); });
    return arguments;
}

template <class Scalar>
bool accepted(Scalar argument) {
    Scalar cosine = 0;
    Scalar sine = 0;
    return cos_sin(&argument, 1, Scalar(1), &cosine, &sine);
}

} // namespace

TEMPLATE_TEST_CASE("cosine and sine are as accurate as documented over the whole range", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double largest : {1.0, 10.0, 100.0, 8192.0}) {
        CAPTURE(largest);
        CHECK(largest_error(random_arguments<TestType>(engine, largest, 200'000)) <
              documented_error<TestType>);
    }
    CHECK(largest_error(quadrant_borders<TestType>()) < documented_error<TestType>);
}

TEMPLATE_TEST_CASE("zero, the smallest and the largest arguments", "", float, double) {
    using Limits = std::numeric_limits<TestType>;
    const TestType largest = largest_cos_sin_argument<TestType>;
    CHECK(largest_error<TestType>({0, -TestType(0), Limits::denorm_min(), -Limits::denorm_min(),
                                   Limits::min(), Limits::epsilon(), largest, -largest}) <
          documented_error<TestType>);
    const TestType zero = 0;
    TestType cosine = 9;
    TestType sine = 9;
    REQUIRE(cos_sin(&zero, 1, TestType(0.25), &cosine, &sine));
    CHECK(cosine == TestType(0.25));
    CHECK(sine == 0);
}

TEMPLATE_TEST_CASE("the amplitude scales both", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto arguments = random_arguments<TestType>(engine, 100, 1000);
    CHECK(largest_error(arguments, TestType(0.0625)) < documented_error<TestType> / 16);
}

TEMPLATE_TEST_CASE("arguments that mean nothing are flagged, wherever they are", "", float, double) {
    using Limits = std::numeric_limits<TestType>;
    const TestType outside = std::nextafter(largest_cos_sin_argument<TestType>, TestType(1e9));
    for (const TestType bad :
         {outside, -outside, Limits::max(), Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
        CHECK_FALSE(accepted(bad));
        for (std::size_t place = 0; place < 37; ++place) {
            std::vector<TestType> arguments(37, TestType(0.5));
            arguments[place] = bad;
            std::vector<TestType> cosine(37);
            std::vector<TestType> sine(37);
            CHECK_FALSE(cos_sin(arguments.data(), 37, TestType(1), cosine.data(), sine.data()));
        }
    }
}

TEMPLATE_TEST_CASE("the cosines may be written over the arguments", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    auto arguments = random_arguments<TestType>(engine, 100, 83);
    std::vector<TestType> cosine(83);
    std::vector<TestType> sine(83);
    std::vector<TestType> other_sine(83);
    cos_sin(arguments.data(), 83, TestType(1), cosine.data(), sine.data());
    cos_sin(arguments.data(), 83, TestType(1), arguments.data(), other_sine.data());
    CHECK(arguments == cosine);
    CHECK(other_sine == sine);
}
