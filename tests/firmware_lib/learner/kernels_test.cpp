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

namespace kernels_test {

using namespace dfdyn;
using detail::panel_width;

constexpr int largest_count = 132; // several vectors of any machine and a remainder

/// Random numbers of magnitude up to 1, followed by a guard that no kernel may change.
template <class Scalar>
std::vector<Scalar> random_numbers(std::mt19937_64& engine, int count) {
    std::uniform_real_distribution<Scalar> number(-1, 1);
    std::vector<Scalar> numbers(static_cast<std::size_t>(count) + 1, Scalar(77));
    std::generate_n(numbers.begin(), count, [&] { return number(engine); });
    return numbers;
}

/// Bound of the rounding error of a sum of `count` products of such numbers.
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

/// Returns element i of column c of a panel.
template <class Scalar>
std::size_t place(int i, int c) {
    constexpr int rows = detail::block_rows<Scalar>;
    return static_cast<std::size_t>((i / rows * panel_width + c) * rows + i % rows);
}

/// Bierman's update of four columns, one after the other.
template <class Scalar>
void naive_panel_update(std::vector<Scalar>& panel, std::vector<Scalar>& gain,
                        const detail::PanelFactors<Scalar>& factors) {
    const int count = static_cast<int>(gain.size()) - 1;
    for (int c = 0; c < panel_width; ++c) {
        for (int i = 0; i < count; ++i) {
            Scalar& u = panel[place<Scalar>(i, c)];
            Scalar& k = gain[static_cast<std::size_t>(i)];
            const Scalar old = u;
            u += factors.mu[c] * k;
            k += factors.v[c] * old;
        }
    }
}

/// Returns true if `products` are those of the panel's columns with the row.
template <class Scalar>
bool are_products(const Scalar (&products)[panel_width], const std::vector<Scalar>& panel,
                  const std::vector<Scalar>& row) {
    const int count = static_cast<int>(row.size()) - 1;
    std::vector<Scalar> column(row.size());
    bool all = true;
    for (int c = 0; c < panel_width; ++c) {
        for (int i = 0; i < count; ++i) {
            column[static_cast<std::size_t>(i)] = panel[place<Scalar>(i, c)];
        }
        all = all && close(products[c], exact_dot(column.data(), row.data(), count), rounding<Scalar>(count));
    }
    return all;
}

constexpr int most_blocks = 17;

template <class Scalar>
bool all_close(const std::vector<Scalar>& values, const std::vector<Scalar>& expected, double tolerance) {
    return std::equal(values.begin(), values.end(), expected.begin(), expected.end(),
                      [&](Scalar a, Scalar b) { return close(a, static_cast<double>(b), tolerance); });
}

TEMPLATE_TEST_CASE("dot and add_scaled are correct for every count and do not exceed it", "", float, double) {
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

TEMPLATE_TEST_CASE("the products of a panel equal those of its four columns", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (int blocks = 0; blocks <= most_blocks; ++blocks) {
        CAPTURE(blocks);
        const auto panel = random_numbers<TestType>(engine, blocks * detail::block_size<TestType>);
        const auto row = random_numbers<TestType>(engine, blocks * detail::block_rows<TestType>);
        TestType products[panel_width] = {9, 9, 9, 9};
        detail::panel_products(panel.data(), blocks, row.data(), products);
        CHECK(are_products(products, panel, row));
    }
}

TEMPLATE_TEST_CASE("the update of a panel equals the updates of its columns in turn", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const detail::PanelFactors<TestType> factors = {
        {TestType(0.3), TestType(-0.8), TestType(0.5), TestType(0.1)},
        {TestType(-0.6), TestType(0.2), TestType(0.9), TestType(-0.4)}};
    for (int blocks = 0; blocks <= most_blocks; ++blocks) {
        CAPTURE(blocks);
        auto panel = random_numbers<TestType>(engine, blocks * detail::block_size<TestType>);
        auto gain = random_numbers<TestType>(engine, blocks * detail::block_rows<TestType>);
        auto expected_panel = panel;
        auto expected_gain = gain;
        naive_panel_update(expected_panel, expected_gain, factors);
        detail::update_panel(panel.data(), blocks, gain.data(), factors);
        CHECK(all_close(panel, expected_panel, rounding<TestType>(panel_width)));
        CHECK(all_close(gain, expected_gain, rounding<TestType>(panel_width)));
    }
}

// Bit for bit, so that slicing after a panel does not change the result.
TEMPLATE_TEST_CASE("the combined kernel equals the update and the products of the next panel", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    const detail::PanelFactors<TestType> factors = {
        {TestType(0.3), TestType(-0.8), TestType(0.5), TestType(0.1)},
        {TestType(-0.6), TestType(0.2), TestType(0.9), TestType(-0.4)}};
    for (int blocks = 0; blocks <= most_blocks; ++blocks) {
        const int next_blocks = blocks + blocks % 2;
        CAPTURE(blocks, next_blocks);
        auto panel = random_numbers<TestType>(engine, blocks * detail::block_size<TestType>);
        auto gain = random_numbers<TestType>(engine, blocks * detail::block_rows<TestType>);
        const auto next = random_numbers<TestType>(engine, next_blocks * detail::block_size<TestType>);
        const auto row = random_numbers<TestType>(engine, next_blocks * detail::block_rows<TestType>);
        auto expected_panel = panel;
        auto expected_gain = gain;
        TestType expected[panel_width];
        detail::update_panel(expected_panel.data(), blocks, expected_gain.data(), factors);
        detail::panel_products(next.data(), next_blocks, row.data(), expected);
        TestType products[panel_width];
        detail::update_panel(panel.data(), blocks, gain.data(), factors, next.data(), next_blocks, row.data(),
                             products);
        CHECK(panel == expected_panel);
        CHECK(gain == expected_gain);
        CHECK(std::equal(products, products + panel_width, expected));
    }
}

} // namespace kernels_test
