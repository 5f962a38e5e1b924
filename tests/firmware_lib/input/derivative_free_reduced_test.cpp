// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/derivative_free_reduced.hpp"

#include "dfdyn/input/derivative_free_structured.hpp"
#include "tests/firmware_lib/support/positions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace derivative_free_reduced_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int joints = 2;
constexpr int lags = 10;
constexpr int rows = 3;
using Rows = std::array<double, rows*(lags + 1)>;

template <class Scalar>
using Constants = typename DerivativeFreeReduced<lags, rows>::template Constants<Scalar, joints>;
template <class Scalar>
using Map = typename DerivativeFreeReduced<lags, rows>::template Map<Scalar, joints>;

template <class Scalar>
Constants<Scalar> constants_of(const Rows& matrix) {
    Rows difference_form{};
    to_difference_form(matrix.data(), rows, lags, difference_form.data());
    Constants<Scalar> constants{};
    std::transform(difference_form.begin(), difference_form.end(), constants.rows.begin(),
                   [](double value) { return static_cast<Scalar>(value); });
    for (int element = 0; element < constants.scale.size(); ++element) {
        constants.scale[element] = static_cast<Scalar>(element + 1) / 8;
    }
    return constants;
}

/// Σ R_jl q_i(t-l), with the factors rounded to `Scalar` and summed in `Sum`.
template <class Scalar, class Sum>
Sum product_with(const Rows& matrix, const Positions& positions, std::size_t i, std::size_t j) {
    Sum sum = 0;
    for (std::size_t lag = 0; lag <= lags; ++lag) {
        const auto position = static_cast<Scalar>(positions[positions.size() - 1 - lag][i]);
        sum +=
            static_cast<Sum>(static_cast<Scalar>(matrix[j * (lags + 1) + lag])) * static_cast<Sum>(position);
    }
    return sum;
}

/// Largest errors of one row's feature along a motion: of the map, and of the plain product in the same
/// precision.
struct Errors {
    double map = 0;
    double plain_product = 0;
};

Errors float_errors(const Rows& matrix, std::size_t j) {
    const Constants<float> constants = constants_of<float>(matrix);
    const Positions motion = smooth_positions(500);
    Errors errors;
    for (std::size_t begin = 0; begin + lags < motion.size(); ++begin) {
        const auto first = motion.begin() + static_cast<std::ptrdiff_t>(begin);
        const Positions window(first, first + lags + 1);
        Positions rounded = window;
        for (auto& row : rounded) {
            for (double& value : row) {
                value = static_cast<double>(static_cast<float>(value));
            }
        }
        Map<float> map(constants, {}, {}, {});
        const auto xi = inputs_after<Map<float>, float, joints>(map, window, joints * rows);
        const double truth = product_with<double, double>(matrix, rounded, 0, j);
        const double value =
            static_cast<double>(xi[j]) / static_cast<double>(constants.scale[static_cast<int>(j)]);
        errors.map = std::max(errors.map, std::abs(value - truth));
        const auto plain = static_cast<double>(product_with<float, float>(matrix, window, 0, j));
        errors.plain_product = std::max(errors.plain_product, std::abs(plain - truth));
    }
    return errors;
}

TEST_CASE("DFR gives the scaled product of R with each joint's window") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 50; ++trial) {
        Rows matrix;
        std::generate(matrix.begin(), matrix.end(),
                      [&] { return std::normal_distribution<double>()(engine); });
        const Constants<double> constants = constants_of<double>(matrix);
        const Positions positions = random_positions(engine, lags + 1 + trial, joints);
        Map<double> map(constants, {}, {}, {});
        const auto xi = inputs_after<Map<double>, double, joints>(map, positions, joints * rows);
        for (std::size_t i = 0; i < joints; ++i) {
            for (std::size_t j = 0; j < rows; ++j) {
                const std::size_t element = i * rows + j;
                const double truth = product_with<double, double>(matrix, positions, i, j);
                CHECK(xi[element] ==
                      Approx(constants.scale[static_cast<int>(element)] * truth).margin(1e-12));
            }
        }
    }
}

TEST_CASE("the difference form keeps the entries of a row and puts its sum first even in place") {
    std::array<double, 6> matrix{1, -2, 4, 8, 16, -32};
    to_difference_form(matrix.data(), 2, 2, matrix.data());
    CHECK(matrix == std::array<double, 6>{3, -2, 4, -8, 16, -32});
}

// At 1 kHz the entries of the acceleration row are about 1e6 and nearly cancel.
TEST_CASE("in float at 1 kHz the difference form is accurate and the plain product is not") {
    Rows matrix{};
    structured_rows<double>({1 / period_s, 1 / (period_s * period_s), 0.3, 0.3}, lags, matrix.data());
    const Errors velocity = float_errors(matrix, 1);
    CAPTURE(velocity.map, velocity.plain_product);
    CHECK(velocity.map < 1e-5);
    CHECK(velocity.plain_product > 100 * velocity.map);
    const Errors acceleration = float_errors(matrix, 2);
    CAPTURE(acceleration.map, acceleration.plain_product);
    CHECK(acceleration.map < 1e-2);
    CHECK(acceleration.plain_product > 20 * acceleration.map);
}

TEST_CASE("DFR is ready after M+1 samples") {
    const Constants<float> constants{};
    Map<float> map(constants, {}, {}, {});
    CHECK(ready_after<float, joints>(map, lags + 1));
    static_assert(Map<float>::cost(4, 10, 3) == 4 * 3 * 12);
}

} // namespace derivative_free_reduced_test
