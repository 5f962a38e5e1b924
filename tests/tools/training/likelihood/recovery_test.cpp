// SPDX-License-Identifier: Apache-2.0
// Data drawn from the model with known hyperparameters, which the search must recover within the accuracy
// that the data allow.
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/likelihood/marginal_likelihood.hpp"
#include "tools/training/search/minimise.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/training/likelihood/gaussian_kernel.hpp"

#include <Eigen/Cholesky>

#include <cmath>

namespace recovery_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 6;

struct Draw {
    tools::NormalSource random;
    tools::TrainingData data;
    tools::RowList rows = dfdyn::tests::rows_between(lags, 700, 3);
    std::unique_ptr<tools::InputMap> input;

    Draw(bool structured, std::uint64_t seed)
        : random(seed), data(dfdyn::tests::arm_data(700, 2, 1, random)) {
        data.positions += 3e-3 * random.matrix(700, 2);
        const tools::LagSpread spread(data.positions, rows, lags);
        input = structured ? tools::lag_input(data.positions, rows, spread,
                                              dfdyn::tests::row_family(tools::InputKind::DFSR, lags))
                           : tools::derivative_input(data, rows, rows, spread, true);
    }

    /// Draws ten outputs of different sizes with covariance rho_k^2 (K + r I).
    MatrixXd outputs(const VectorXd& theta) {
        const MatrixXd inputs = input->inputs(theta.tail(theta.size() - 2));
        MatrixXd covariance = tools::gaussian_kernel(inputs, std::exp(theta[1]));
        covariance.diagonal().array() += std::exp(theta[0]);
        const MatrixXd white =
            random.matrix(inputs.rows(), 10) * VectorXd::LinSpaced(10, 0.1, 20).asDiagonal();
        return covariance.llt().matrixL() * white;
    }
};

/// Negative second derivatives of log L at its maximum: the information of the data about theta.
MatrixXd information(const tools::MarginalLikelihood& likelihood, const VectorXd& theta) {
    MatrixXd result(theta.size(), theta.size());
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
        const auto slope = [&](const VectorXd& at) { return 0.5 * likelihood.evaluate(at)->gradient[i]; };
        result.row(i) = dfdyn::tests::differences(slope, theta).transpose();
    }
    return 0.5 * (result + result.transpose());
}

TEST_CASE("hyperparameters are recovered from data drawn from the model") {
    const bool structured = GENERATE(false, true);
    const std::uint64_t seed = GENERATE(11U, 12U, 13U);
    CAPTURE(structured, seed);
    Draw draw(structured, seed);
    const VectorXd truth = structured ? VectorXd{{std::log(0.01), std::log(2.0), 0.4, -0.5, 0.2, 0.8}}
                                      : VectorXd{{std::log(0.01), std::log(2.0), 0.5, -0.7}};
    const tools::ProfiledVarianceLikelihood outputs(draw.outputs(truth));
    const tools::MarginalLikelihood likelihood(*draw.input, outputs);
    const auto value_of = [&](const VectorXd& theta) -> std::optional<tools::PointValue> {
        const auto value = likelihood.evaluate(theta);
        return tools::PointValue{value->minus_two_log_likelihood, value->gradient};
    };
    const VectorXd start = likelihood.start(0, draw.random);
    const tools::Minimum minimum = tools::minimise(value_of, likelihood.bounds(), start, 1e-4, 300);
    const VectorXd error = minimum.point - truth;
    const MatrixXd curvature = information(likelihood, minimum.point);
    // Asymptotically chi-squared with one degree of freedom per parameter; the 0.999 quantiles.
    CHECK(error.dot(curvature * error) < (structured ? 22.5 : 18.5));
    const MatrixXd covariance = tools::inverse_matrix(curvature);
    CHECK(covariance.diagonal().minCoeff() > 0);
    CHECK(std::sqrt(covariance(0, 0)) < 0.15); // the data determine the noise and the length scale
    CHECK(std::sqrt(covariance(1, 1)) < 0.15);
    // Asymptotically half a chi-squared variable as well.
    CHECK(likelihood.evaluate(truth)->minus_two_log_likelihood - minimum.value < (structured ? 22.5 : 18.5));
    CHECK(minimum.value < likelihood.evaluate(truth)->minus_two_log_likelihood);
}

} // namespace recovery_test
