// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/learner/kernels.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace {

using namespace dfdyn;
using detail::panel_width;

constexpr int largest_count = 132; // several vectors of any machine and a rest

/// Numbers of size 1, with a guard behind them that no kernel may touch.
template <class Scalar>
std::vector<Scalar> random_numbers(std::mt19937_64& engine, int count) {
    std::uniform_real_distribution<Scalar> number(-1, 1);
    std::vector<Scalar> numbers(static_cast<std::size_t>(count) + 1, Scalar(77));
    std::generate_n(numbers.begin(), count, [&] { return number(engine); });
    return numbers;
}

/// What rounding may do to a sum of `count` products of numbers of size 1.
template <class Scalar>
double rounding(int count) {
    return (count + 2) * static_cast<double>(std::numeric_limits<Scalar>::epsilon());
}

template <class Scalar>
double exact_dot(const Scalar* a, const Scalar* b, int count) {
    long double sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += static_cast<long double>(a[i]) * static_cast<long double>(b[i]);
    }
    return static_cast<double>(sum);
}

template <class Scalar>
bool close(Scalar value, double exact, double tolerance) {
    return std::abs(static_cast<double>(value) - exact) <= tolerance;
}

/// Bierman's update of four columns, one after the other.
template <class Scalar>
void naive_panel_update(std::vector<Scalar>& columns, std::vector<Scalar>& gain, int count,
                        const Scalar (&v)[panel_width], const Scalar (&mu)[panel_width]) {
    for (int c = 0; c < panel_width; ++c) {
        Scalar* const column = columns.data() + static_cast<std::ptrdiff_t>(c) * count;
        for (int i = 0; i < count; ++i) {
            Scalar& u = column[i];
            Scalar& k = gain[static_cast<std::size_t>(i)];
            const Scalar old = u;
            u += mu[c] * k;
            k += v[c] * old;
        }
    }
}

template <class Scalar>
bool all_close(const std::vector<Scalar>& values, const std::vector<Scalar>& expected, double tolerance) {
    return std::equal(values.begin(), values.end(), expected.begin(), expected.end(),
                      [&](Scalar a, Scalar b) { return close(a, static_cast<double>(b), tolerance); });
}

} // namespace

TEMPLATE_TEST_CASE("dot and add_scaled are right for every count, and stay within it", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (int count = 0; count <= largest_count; ++count) {
        CAPTURE(count);
        const auto a = random_numbers<TestType>(engine, count);
        auto b = random_numbers<TestType>(engine, count);
        CHECK(close(detail::dot(a.data(), b.data(), count), exact_dot(a.data(), b.data(), count),
                    rounding<TestType>(count)));
        auto expected = b;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            expected[i] += TestType(0.7) * a[i];
        }
        detail::add_scaled(TestType(0.7), a.data(), b.data(), count);
        CHECK(all_close(b, expected, rounding<TestType>(1)));
    }
}

TEMPLATE_TEST_CASE("a panel's products are those of its four columns", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (int count = 0; count <= largest_count; count += panel_width) {
        CAPTURE(count);
        const auto columns = random_numbers<TestType>(engine, panel_width * count);
        const auto row = random_numbers<TestType>(engine, count);
        TestType products[panel_width] = {9, 9, 9, 9};
        detail::panel_dots(columns.data(), row.data(), count, products);
        for (int c = 0; c < panel_width; ++c) {
            CHECK(close(products[c], exact_dot(columns.data() + c * count, row.data(), count),
                        rounding<TestType>(count)));
        }
    }
}

TEMPLATE_TEST_CASE("a panel's update is that of its columns one after the other", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const TestType v[panel_width] = {TestType(0.3), TestType(-0.8), TestType(0.5), TestType(0.1)};
    const TestType mu[panel_width] = {TestType(-0.6), TestType(0.2), TestType(0.9), TestType(-0.4)};
    for (int count = 0; count <= largest_count; count += panel_width) {
        CAPTURE(count);
        auto columns = random_numbers<TestType>(engine, panel_width * count);
        auto gain = random_numbers<TestType>(engine, count);
        auto expected_columns = columns;
        auto expected_gain = gain;
        naive_panel_update(expected_columns, expected_gain, count, v, mu);
        detail::panel_update(columns.data(), gain.data(), count, v, mu);
        CHECK(all_close(columns, expected_columns, rounding<TestType>(panel_width)));
        CHECK(all_close(gain, expected_gain, rounding<TestType>(panel_width)));
    }
}
