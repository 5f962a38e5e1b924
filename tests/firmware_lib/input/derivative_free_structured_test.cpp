// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/derivative_free_structured.hpp"

#include "tests/firmware_lib/support/positions.hpp" // period_s
#include "tests/support/catch.hpp"

#include <cmath>
#include <vector>

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

static_assert(DerivativeFreeStructured<lags>::lags == lags);
static_assert(DerivativeFreeStructured<lags>::features_per_joint == 3);

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

} // namespace derivative_free_structured_test
