// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/derivative_free_structured.hpp"

#include "tests/firmware_lib/support/positions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>

namespace derivative_free_structured_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int lags = 25;
constexpr StructuredFilters<double> filters{1 / period_s, 1 / (period_s * period_s), 0.7, 0.8};

std::vector<double> fir_rows() {
    std::vector<double> rows(3 * (lags + 1));
    structured_rows(filters, lags, rows.data());
    return rows;
}

/// The filters as difference equations of their transfer functions, at rest before the first position.
struct DirectRecursion {
    std::vector<double> velocity, acceleration;

    explicit DirectRecursion(const std::vector<double>& q, double before) {
        const auto at = [&](int t) { return t < 0 ? before : q[static_cast<std::size_t>(t)]; };
        double v = 0;
        double a = 0;
        for (int t = 0; t < static_cast<int>(q.size()); ++t) {
            v = filters.beta1 * v + filters.alpha1 * (at(t) - at(t - 1));
            a = filters.beta2 * a + filters.alpha2 * (at(t) - 2 * at(t - 1) + at(t - 2));
            velocity.push_back(v);
            acceleration.push_back(a);
        }
    }
};

using Recursive = DerivativeFreeStructuredRecursive<lags>;
using RecursiveMap = Recursive::Map<double, 1>;

Recursive::Constants<double, 1> recursive_constants() { return {filters, {{0.5, 2, 4}}}; }

/// Positions of joint 1 during a smooth motion.
std::vector<double> smooth_joint(int count) {
    std::vector<double> q;
    for (const std::vector<double>& row : smooth_positions(count)) {
        q.push_back(row[0]);
    }
    return q;
}

void push(RecursiveMap& map, double position) {
    map.push(Sample<double, 1, 1>{0, {{position}}, {{0}}, false});
}

TEST_CASE("the rows of DFSR equal the paper's") {
    const std::vector<double> rows = fir_rows();
    const auto [alpha1, alpha2, beta1, beta2] = filters;
    for (int lag = 0; lag <= lags; ++lag) {
        CAPTURE(lag);
        const auto index = static_cast<std::size_t>(lag);
        CHECK(rows[index] == (lag == 0 ? 1 : 0));
        const double velocity = lag == 0 ? alpha1 : alpha1 * std::pow(beta1, lag - 1) * (beta1 - 1);
        CHECK(rows[index + lags + 1] == Approx(velocity).epsilon(1e-12));
        const double acceleration = lag == 0 ? alpha2
                                    : lag == 1
                                        ? alpha2 * (beta2 - 2)
                                        : alpha2 * std::pow(beta2, lag - 2) * (beta2 * beta2 - 2 * beta2 + 1);
        CHECK(rows[index + 2 * (lags + 1)] == Approx(acceleration).epsilon(1e-12));
    }
}

TEST_CASE("the rows of DFSR are the impulse responses of their transfer functions") {
    const std::vector<double> rows = fir_rows();
    std::vector<double> impulse(lags + 1, 0);
    impulse[0] = 1;
    const DirectRecursion response(impulse, 0);
    for (std::size_t lag = 0; lag <= lags; ++lag) {
        CHECK(rows[lag + lags + 1] == Approx(response.velocity[lag]).epsilon(1e-11));
        CHECK(rows[lag + 2 * (lags + 1)] == Approx(response.acceleration[lag]).epsilon(1e-10));
    }
}

TEST_CASE("the recursive filter equals the difference equation, at rest before its first position") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<double> q(300);
    std::generate(q.begin(), q.end(), [&] { return std::uniform_real_distribution<double>(-3, 3)(engine); });
    const auto constants = recursive_constants();
    RecursiveMap map(constants, {}, {}, {});
    for (int turn = 0; turn < 2; ++turn) {
        map.restart();
        const DirectRecursion truth(q, q.front());
        for (std::size_t t = 0; t < q.size(); ++t) {
            push(map, q[t]);
            double xi[3];
            map.evaluate(xi);
            REQUIRE(xi[0] == 0.5 * q[t]);
            REQUIRE(xi[1] == Approx(2 * truth.velocity[t]).epsilon(1e-12).margin(1e-9));
            REQUIRE(xi[2] == Approx(4 * truth.acceleration[t]).epsilon(1e-12).margin(1e-6));
        }
        std::reverse(q.begin(), q.end());
    }
}

// The truncation error of the rows is a geometric tail: α₁β₁^M |q| for the velocity, α₂β₂^(M-1)(1-β₂) |q| for
// the acceleration.
TEST_CASE("the recursive filter differs from the rows by at most their truncation error") {
    const std::vector<double> q = smooth_joint(400);
    const std::vector<double> rows = fir_rows();
    const double largest = *std::max_element(q.begin(), q.end());
    const double velocity_bound = filters.alpha1 * std::pow(filters.beta1, lags) * largest;
    const double acceleration_bound =
        filters.alpha2 * std::pow(filters.beta2, lags - 1) * (1 - filters.beta2) * largest;
    const auto constants = recursive_constants();
    RecursiveMap map(constants, {}, {}, {});
    for (int t = 0; t < static_cast<int>(q.size()); ++t) {
        push(map, q[static_cast<std::size_t>(t)]);
        if (!map.ready()) {
            continue;
        }
        double fir[2] = {0, 0};
        for (std::size_t lag = 0; lag <= lags; ++lag) {
            const double position = q[static_cast<std::size_t>(t) - lag];
            fir[0] += rows[lag + lags + 1] * position;
            fir[1] += rows[lag + 2 * (lags + 1)] * position;
        }
        double xi[3];
        map.evaluate(xi);
        REQUIRE(std::abs(xi[1] / 2 - fir[0]) <= velocity_bound * (1 + 1e-9));
        REQUIRE(std::abs(xi[2] / 4 - fir[1]) <= acceleration_bound * (1 + 1e-9));
    }
}

TEST_CASE("an arm that never moved has exactly no velocity and no acceleration") {
    const auto constants = recursive_constants();
    RecursiveMap map(constants, {}, {}, {});
    for (int t = 0; t < 100; ++t) {
        push(map, 2.9);
        double xi[3];
        map.evaluate(xi);
        REQUIRE(xi[1] == 0);
        REQUIRE(xi[2] == 0);
    }
}

TEST_CASE("after a motion the filters reach exactly zero, without denormals") {
    const auto constants = recursive_constants();
    RecursiveMap map(constants, {}, {}, {});
    push(map, 0);
    int subnormal = 0;
    double xi[3] = {0, 0, 0};
    for (int t = 0; t < 10'000; ++t) {
        push(map, 2.9);
        map.evaluate(xi);
        subnormal += std::fpclassify(xi[1]) == FP_SUBNORMAL || std::fpclassify(xi[2]) == FP_SUBNORMAL ? 1 : 0;
    }
    CHECK(subnormal == 0);
    CHECK(xi[1] == 0);
    CHECK(xi[2] == 0);
}

TEST_CASE("the recursive filter is ready after M+1 samples, as the rows are") {
    const auto constants = recursive_constants();
    RecursiveMap map(constants, {}, {}, {});
    CHECK(ready_after<double, 1>(map, lags + 1));
    static_assert(DerivativeFreeStructured<lags>::lags == lags);
    static_assert(DerivativeFreeStructured<lags>::features_per_joint == 3);
}

} // namespace derivative_free_structured_test
