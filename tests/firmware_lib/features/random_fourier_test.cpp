// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/features/random_fourier.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace random_fourier_test {

using namespace dfdyn;

constexpr int inputs = 4;
using Features = RandomFourier<dynamic>;
using Constants = Features::Constants<double, inputs>;
using Input = std::vector<double>;

Constants random_constants(std::mt19937_64& engine, int feature_count) {
    Constants constants{Storage<double, dynamic>::zeros({inputs * feature_count}),
                        1 / std::sqrt(feature_count)};
    std::normal_distribution<double> normal;
    std::generate(constants.frequencies.begin(), constants.frequencies.end(), [&] { return normal(engine); });
    return constants;
}

Input random_input(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    Input xi(inputs);
    std::generate(xi.begin(), xi.end(), [&] { return normal(engine); });
    return xi;
}

std::vector<double> features(const Constants& constants, const Input& xi) {
    const int feature_count = constants.frequencies.size() / inputs;
    std::vector<double> phi(2 * static_cast<std::size_t>(feature_count));
    REQUIRE(Features::evaluate(constants, Extent<inputs>{}, Extent<dynamic>{feature_count}, xi.data(),
                               phi.data()));
    return phi;
}

double inner_product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

double gaussian_kernel(const Input& a, const Input& b) {
    double square = 0;
    for (std::size_t i = 0; i < inputs; ++i) {
        square += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return std::exp(-square / 2);
}

/// Root mean square of φ(ξ)'φ(ξ') - K_G(ξ, ξ') over many pairs and draws of ω.
double kernel_error(std::mt19937_64& engine, int feature_count) {
    constexpr int draws = 400;
    double sum = 0;
    for (int draw = 0; draw < draws; ++draw) {
        const Constants constants = random_constants(engine, feature_count);
        const Input a = random_input(engine);
        const Input b = random_input(engine);
        const double error =
            inner_product(features(constants, a), features(constants, b)) - gaussian_kernel(a, b);
        sum += error * error;
    }
    return std::sqrt(sum / draws);
}

TEST_CASE("the columns are the cosines followed by the sines of frequencies times input") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::size_t feature_count : {1U, 2U, 7U, 33U, 250U}) {
        const Constants constants = random_constants(engine, static_cast<int>(feature_count));
        const Input xi = random_input(engine);
        const std::vector<double> phi = features(constants, xi);
        for (std::size_t b = 0; b < feature_count; ++b) {
            double argument = 0;
            for (std::size_t a = 0; a < inputs; ++a) {
                argument += constants.frequencies[static_cast<int>(a * feature_count + b)] * xi[a];
            }
            CHECK(phi[b] == Approx(std::cos(argument) * constants.amplitude).margin(1e-14));
            CHECK(phi[b + feature_count] == Approx(std::sin(argument) * constants.amplitude).margin(1e-14));
        }
    }
}

TEST_CASE("the column vector of any input has norm one") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 100; ++trial) {
        const Constants constants = random_constants(engine, 1 + trial);
        const std::vector<double> phi = features(constants, random_input(engine));
        CHECK(inner_product(phi, phi) == Approx(1).epsilon(1e-14));
    }
}

// φ'φ' is a mean of d bounded terms whose expectation is the kernel, so its error is proportional to 1/√d.
// 400 draws determine each error to about 4 %.
TEST_CASE("the error of the kernel approximation decreases with the square root of the number of columns") {
    DFDYN_SEEDED_ENGINE(engine);
    const double few = kernel_error(engine, 16);
    const double many = kernel_error(engine, 256);
    CAPTURE(few, many);
    CHECK(few < 0.25); // a mean of 16 terms with a variance below one each
    CHECK(few / many == Approx(4).epsilon(0.25));
}

TEST_CASE("inputs that are NaN or far outside the training data are flagged") {
    DFDYN_SEEDED_ENGINE(engine);
    const Constants constants = random_constants(engine, 20);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 1e6}) {
        for (std::size_t place = 0; place < inputs; ++place) {
            Input xi = random_input(engine);
            xi[place] = bad;
            std::vector<double> phi(40);
            CHECK_FALSE(
                Features::evaluate(constants, Extent<inputs>{}, Extent<dynamic>{20}, xi.data(), phi.data()));
        }
    }
}

} // namespace random_fourier_test
