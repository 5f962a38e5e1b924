// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/features/cos_sin.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace cos_sin_test {

using dfdyn::cos_sin;
using dfdyn::largest_cos_sin_argument;

template <class Scalar>
constexpr double documented_error = std::is_same_v<Scalar, float> ? 1.2e-7 : 3e-16;

/// Returns the larger error. NaN counts as infinite.
template <class Real>
Real worse(Real largest, Real error) {
    if (error <= largest) {
        return largest;
    }
    return std::isnan(error) ? std::numeric_limits<Real>::infinity() : error;
}

/// Returns the largest absolute error of either function over some arguments, against the C library in
/// extended precision.
template <class Scalar>
double largest_error(const std::vector<Scalar>& arguments, Scalar amplitude = 1) {
    const auto count = arguments.size();
    std::vector<Scalar> cosine(count);
    std::vector<Scalar> sine(count);
    REQUIRE(cos_sin(arguments.data(), static_cast<int>(count), amplitude, cosine.data(), sine.data()));
    long double largest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const long double x = arguments[i];
        largest = worse(largest, std::abs(cosine[i] - amplitude * std::cos(x)));
        largest = worse(largest, std::abs(sine[i] - amplitude * std::sin(x)));
    }
    return static_cast<double>(largest);
}

/// A few thousand values, adjacent in the last place, near multiples of π/4.
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

/// Returns the largest absolute error over all floats with bits `first` … `last` - 1, against double
/// precision, whose own error is negligible. Infinity if an argument is not accepted.
double largest_error_of_all(std::uint32_t first, std::uint32_t last) {
    constexpr int count = 2048;
    std::array<float, count> argument{};
    std::array<float, count> cosine{};
    std::array<float, count> sine{};
    std::array<double, count> exact_argument{};
    std::array<double, count> exact_cosine{};
    std::array<double, count> exact_sine{};
    std::array<double, count> errors{};
    bool accepted = true;
    for (std::uint32_t bits = first; bits < last; bits += count) {
        for (std::uint32_t i = 0; i < count; ++i) { // the last block repeats the last float
            argument[i] = std::bit_cast<float>(std::min(bits + i, last - 1));
            exact_argument[i] = static_cast<double>(argument[i]);
        }
        accepted = cos_sin(argument.data(), count, 1.0F, cosine.data(), sine.data()) && accepted;
        accepted =
            cos_sin(exact_argument.data(), count, 1.0, exact_cosine.data(), exact_sine.data()) && accepted;
        for (std::size_t i = 0; i < count; ++i) {
            errors[i] = worse(errors[i], std::abs(static_cast<double>(cosine[i]) - exact_cosine[i]));
            errors[i] = worse(errors[i], std::abs(static_cast<double>(sine[i]) - exact_sine[i]));
        }
    }
    return accepted ? std::ranges::max(errors) : std::numeric_limits<double>::infinity();
}

constexpr std::uint32_t sign_bit = 0x80000000;
const auto largest_bits = std::bit_cast<std::uint32_t>(largest_cos_sin_argument<float>);

template <class Scalar>
bool accepted(Scalar argument) {
    Scalar cosine = 0;
    Scalar sine = 0;
    return cos_sin(&argument, 1, Scalar(1), &cosine, &sine);
}

TEMPLATE_TEST_CASE("cosine and sine are as accurate as documented over the whole range", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double largest : {1.0, 10.0, 100.0, 8192.0}) {
        CAPTURE(largest);
        CHECK(largest_error(random_arguments<TestType>(engine, largest, 200'000)) <
              documented_error<TestType>);
    }
    CHECK(largest_error(quadrant_borders<TestType>()) < documented_error<TestType>);
}

// Below 2⁻¹² the cosine is 1 - x²/2 and the sine x up to the last bit but one, so random arguments suffice
// there.
TEST_CASE("every float in the first half of the first quadrant is as accurate as documented") {
    const auto eighth_turn = std::bit_cast<std::uint32_t>(0.7853983F);
    const auto small = std::bit_cast<std::uint32_t>(0x1p-12F);
    CHECK(largest_error_of_all(small, eighth_turn) < documented_error<float>);
}

TEST_CASE("every float of the whole range is as accurate as documented", "[.long]") {
    CHECK(largest_error_of_all(0, largest_bits + 1) < documented_error<float>);
    CHECK(largest_error_of_all(sign_bit, sign_bit + largest_bits + 1) < documented_error<float>);
}

// The assumptions of the bound for double.
TEMPLATE_TEST_CASE("the products of the reduction are exact and the truncation error is below a rounding", "",
                   float, double) {
    constexpr auto& parts = dfdyn::detail::HalfPi<TestType>::parts;
    constexpr int last = static_cast<int>(std::size(parts)) - 1;
    const auto quarters = static_cast<int>(largest_cos_sin_argument<double> / 1.57 + 1);
    bool exact = true;
    long double error = -0x1.921fb544p0L; // minus π/2 in two exact parts
    for (int i = 0; i <= last; ++i) {
        error += static_cast<long double>(parts[i]);
        for (int k = 1; k <= quarters && i < last; ++k) {
            const TestType product = static_cast<TestType>(k) * parts[i];
            exact = exact && static_cast<long double>(product) == static_cast<long double>(parts[i]) * k;
        }
    }
    CHECK(exact);
    const long double precision = std::numeric_limits<TestType>::epsilon();
    error -= 0x4.2d18469898cc517p-36L;
    CHECK(std::abs(error) * quarters < precision / 100);
    constexpr int terms =
        dfdyn::detail::taylor_terms<TestType>; // of the cosine beyond the 1; the next term has this power
    const long double eighth_turn = std::acos(-1.0L) / 4;
    CHECK(std::pow(eighth_turn, 2 * terms + 2) / std::tgamma(2.0L * terms + 3) < precision / 50);
    CHECK(std::pow(eighth_turn, 2 * terms + 1) / std::tgamma(2.0L * terms + 2) < precision / 4);
}

TEMPLATE_TEST_CASE("zero, the smallest and the largest arguments are correct", "", float, double) {
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

TEMPLATE_TEST_CASE("the amplitude scales cosine and sine", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto arguments = random_arguments<TestType>(engine, 100, 1000);
    CHECK(largest_error(arguments, TestType(0.0625)) < documented_error<TestType> / 16);
}

TEMPLATE_TEST_CASE("invalid arguments are flagged in any position", "", float, double) {
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

TEMPLATE_TEST_CASE("one argument gives the same values as among others, and NaN beyond the range", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto arguments = random_arguments<TestType>(engine, 100, 83);
    std::vector<TestType> cosine(83);
    std::vector<TestType> sine(83);
    cos_sin(arguments.data(), 83, TestType(1), cosine.data(), sine.data());
    TestType c = 9;
    TestType s = 9;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        dfdyn::cos_sin_of(arguments[i], c, s);
        CHECK((c == cosine[i] && s == sine[i]));
    }
    dfdyn::cos_sin_of(TestType(9000), c, s);
    CHECK((std::isnan(c) && std::isnan(s)));
}

TEMPLATE_TEST_CASE("the cost counts vectors of four arguments on every machine", "", float, double) {
    const std::int64_t vector = dfdyn::cos_sin_cost<TestType>(4);
    CHECK(dfdyn::cos_sin_cost<TestType>(1) == vector);
    CHECK(dfdyn::cos_sin_cost<TestType>(5) == 2 * vector);
    CHECK(dfdyn::cos_sin_cost<TestType>(16) == 4 * vector);
}

TEMPLATE_TEST_CASE("the cosines may overwrite the arguments", "", float, double) {
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

} // namespace cos_sin_test
