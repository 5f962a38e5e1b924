// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/derivative_rows.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace derivative_rows_test {

namespace tools = dfdyn::tools;
using Eigen::VectorXd;

/// Impulse response of (numerator) / (1 - beta z^-1), computed by its recursion.
VectorXd impulse_response(const std::vector<double>& numerator, double beta, int lags) {
    VectorXd response(lags + 1);
    double state = 0;
    for (int t = 0; t <= lags; ++t) {
        const auto index = static_cast<std::size_t>(t);
        state = beta * state + (index < numerator.size() ? numerator[index] : 0);
        response[t] = state;
    }
    return response;
}

TEST_CASE("filtered rows are the impulse responses of the paper's filters") {
    const double beta = GENERATE(0.01, 0.3, 0.9, 0.99);
    const int lags = GENERATE(1, 2, 3, 20);
    CAPTURE(beta, lags);
    const VectorXd velocity = impulse_response({1, -1}, beta, lags);
    const VectorXd acceleration = impulse_response({1, -2, 1}, beta, lags);
    CHECK((tools::filtered_velocity_row(beta, lags) - velocity).norm() < 1e-14);
    CHECK((tools::filtered_acceleration_row(beta, lags) - acceleration).norm() < 1e-14);
}

TEST_CASE("the slopes of the filtered rows equal finite differences") {
    const double beta = GENERATE(0.01, 0.3, 0.9);
    const int lags = GENERATE(1, 2, 8);
    CAPTURE(beta, lags);
    for (Eigen::Index lag = 0; lag <= lags; ++lag) {
        const auto velocity = [&](const VectorXd& at) {
            return tools::filtered_velocity_row(at[0], lags)[lag];
        };
        const auto acceleration = [&](const VectorXd& at) {
            return tools::filtered_acceleration_row(at[0], lags)[lag];
        };
        const VectorXd at = VectorXd::Constant(1, beta);
        CHECK(tools::filtered_velocity_row_slope(beta, lags)[lag] ==
              Approx(dfdyn::tests::differences(velocity, at)[0]).margin(1e-9));
        CHECK(tools::filtered_acceleration_row_slope(beta, lags)[lag] ==
              Approx(dfdyn::tests::differences(acceleration, at)[0]).margin(1e-9));
    }
}

TEST_CASE("polynomial rows differentiate polynomials of their degree exactly") {
    const int order = GENERATE(0, 1, 2, 3);
    const int degree = GENERATE(3, 4);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(order, degree);
    constexpr int lags = 9;
    tools::NormalSource random(dfdyn::tests::seed());
    const VectorXd coefficients = random.matrix(degree + 1, 1);
    VectorXd window = VectorXd::Zero(lags + 1); // values of a polynomial in the time since the newest sample
    for (int lag = 0; lag <= lags; ++lag) {
        for (int power = 0; power <= degree; ++power) {
            window[lag] += coefficients[power] * std::pow(-lag, power);
        }
    }
    const double found = tools::polynomial_derivative_row(order, degree, lags).dot(window);
    CHECK(found == Approx(coefficients[order] * std::pow(lags, order)).epsilon(1e-9));
}

TEST_CASE("a polynomial row with more samples than coefficients amplifies noise less") {
    const double tight = tools::polynomial_derivative_row(1, 9, 9).norm();
    CHECK(tools::polynomial_derivative_row(1, 1, 9).norm() < tight / 10);
}

} // namespace derivative_rows_test
