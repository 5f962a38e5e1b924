// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/feature_likelihood.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"

#include <cmath>

namespace feature_likelihood_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 4;
constexpr int features = 8;

struct Problem {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::RowList rows = dfdyn::tests::rows_between(lags, 45);
    tools::TrainingData data = dfdyn::tests::arm_data(45, 2, 3, random);
    std::unique_ptr<tools::InputMap> input =
        tools::lag_input(data.positions, rows, tools::LagSpread(data.positions, rows, lags),
                         dfdyn::tests::row_family(tools::InputKind::DFSR, lags));
    MatrixXd outputs = data.outputs(rows, Eigen::all).rowwise() - data.outputs.colwise().mean();
    tools::ProfiledVarianceLikelihood output_likelihood{outputs};
    MatrixXd omega = random.matrix(features, 6);
    VectorXd theta{{-3.0, 0.7, 0.1, -0.2, 0.3, -0.4}};
};

TEST_CASE("FeatureLikelihood is the normal density of the outputs with the features' kernel plus noise") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Problem problem;
    const MatrixXd phases =
        problem.input->inputs(problem.theta.tail(4)) * problem.omega.transpose() / std::exp(problem.theta[1]);
    MatrixXd covariance(phases.rows(), phases.rows());
    for (Eigen::Index s = 0; s < phases.rows(); ++s) {
        for (Eigen::Index t = 0; t < phases.rows(); ++t) {
            covariance(s, t) = (phases.row(s) - phases.row(t)).array().cos().mean() +
                               (s == t ? std::exp(problem.theta[0]) : 0);
        }
    }
    const tools::FeatureLikelihood likelihood(*problem.input, problem.output_likelihood, problem.omega);
    const auto value = likelihood.evaluate(problem.theta);
    REQUIRE(value);
    double expected = 0;
    for (Eigen::Index k = 0; k < problem.outputs.cols(); ++k) {
        expected +=
            dfdyn::tests::log_normal_density(problem.outputs.col(k), value->output_variance[k] * covariance);
    }
    CHECK(-0.5 * value->minus_two_log_likelihood == Approx(expected).epsilon(1e-9));
}

TEST_CASE("the gradient of FeatureLikelihood equals finite differences") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Problem problem;
    const tools::FeatureLikelihood likelihood(*problem.input, problem.output_likelihood, problem.omega);
    const auto value_at = [&](const VectorXd& at) {
        return likelihood.evaluate(at)->minus_two_log_likelihood;
    };
    CHECK(dfdyn::tests::relative_error(likelihood.evaluate(problem.theta)->gradient,
                                       dfdyn::tests::differences(value_at, problem.theta)) < 1e-6);
}

TEST_CASE("FeatureLikelihood is the same in blocks of samples as in one") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Problem problem;
    const auto value_of = [&](Eigen::Index rows_at_once) {
        return tools::FeatureLikelihood(*problem.input, problem.output_likelihood, problem.omega,
                                        rows_at_once)
            .evaluate(problem.theta);
    };
    const auto whole = value_of(41);
    REQUIRE(whole);
    for (const Eigen::Index rows_at_once : {1, 7, 40}) {
        CAPTURE(rows_at_once);
        const auto blocks = value_of(rows_at_once);
        REQUIRE(blocks);
        CHECK(blocks->minus_two_log_likelihood == Approx(whole->minus_two_log_likelihood).epsilon(1e-10));
        CHECK(dfdyn::tests::relative_error(blocks->gradient, whole->gradient) < 1e-8);
        CHECK(dfdyn::tests::relative_error(blocks->output_variance, whole->output_variance) < 1e-10);
    }
}

TEST_CASE("the features of a long recording are computed in blocks of at most 200 MB") {
    for (const Eigen::Index frequencies : {10, 250, 5000}) {
        const Eigen::Index rows = tools::feature_rows_at_once(frequencies);
        CHECK(rows >= 1);
        CHECK(static_cast<double>(rows * frequencies) * 9 * sizeof(double) <= 2e8);
    }
    CHECK(tools::feature_rows_at_once(250) > 10'000);
}

} // namespace feature_likelihood_test
