// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/variance_components.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/likelihood/linear_model.hpp"
#include "tests/tools/training/numerics.hpp"

namespace variance_components_test {

namespace tools = dfdyn::tools;
using dfdyn::tests::LinearModel;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::PhysicsPrior;

VectorXd some_variances(PhysicsPrior prior) {
    VectorXd x(LinearModel::outputs + LinearModel::groups(prior));
    for (Index i = 0; i < x.size(); ++i) {
        x[i] = 0.4 * static_cast<double>(i % 3) - 0.5;
    }
    return x;
}

TEST_CASE("the variance criterion and its derivatives are those of the normal density of the outputs") {
    const auto prior = GENERATE(PhysicsPrior::none, PhysicsPrior::shared, PhysicsPrior::diagonal);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(static_cast<int>(prior));
    const LinearModel model(dfdyn::tests::seed());
    const VectorXd x = some_variances(prior);
    const auto at = tools::variance_criterion(model.statistics(), prior, x);
    REQUIRE(at);
    const double determinant = std::log(model.covariance.determinant());
    CHECK(at->value + LinearModel::outputs * determinant ==
          Approx(-2 * model.log_density(prior, x)).epsilon(1e-10));
    const auto value = [&](const VectorXd& y) {
        return tools::variance_criterion(model.statistics(), prior, y)->value;
    };
    CHECK(dfdyn::tests::relative_error(at->gradient, dfdyn::tests::differences(value, x)) < 1e-7);
    for (Index i = 0; i < x.size(); ++i) {
        const auto slope = [&](const VectorXd& y) {
            return tools::variance_criterion(model.statistics(), prior, y)->gradient[i];
        };
        CHECK(dfdyn::tests::relative_error(at->hessian.col(i), dfdyn::tests::differences(slope, x)) < 1e-7);
    }
}

TEST_CASE("the best variances minimise the criterion") {
    const auto prior = GENERATE(PhysicsPrior::none, PhysicsPrior::shared);
    const std::uint64_t seed = dfdyn::tests::seed() + GENERATE(range(0U, 5U));
    CAPTURE(static_cast<int>(prior), seed);
    const LinearModel model(seed);
    const auto best = tools::best_variances(model.statistics(), prior);
    REQUIRE(best);
    CHECK(best->at.gradient.head(LinearModel::outputs).cwiseAbs().maxCoeff() < 1e-8);
    VectorXd x(LinearModel::outputs + LinearModel::groups(prior));
    x << best->output_variance.array().log(),
        best->prior_variance.head(LinearModel::groups(prior)).array().log();
    tools::NormalSource random(seed, 9);
    for (int i = 0; i < 20; ++i) {
        const VectorXd elsewhere = x + 0.3 * random.matrix(x.size(), 1);
        CHECK(model.log_density(prior, elsewhere) <= model.log_density(prior, x) + 1e-9);
    }
    // The rounding of sums depends on the alignment of their terms.
    CHECK(best->at.value ==
          Approx(tools::variance_criterion(model.statistics(), prior, x)->value).epsilon(1e-13));
}

TEST_CASE("the variance of a prior can be fixed while those of the outputs are estimated") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const LinearModel model(dfdyn::tests::seed());
    const VectorXd log_prior{{0.5, -1, 20, -20}};
    const auto best = tools::best_variances(model.statistics(), PhysicsPrior::diagonal, log_prior);
    REQUIRE(best);
    CHECK((best->prior_variance.array().log().matrix() - log_prior).norm() < 1e-12);
    CHECK(best->at.gradient.head(LinearModel::outputs).cwiseAbs().maxCoeff() < 1e-8);
}

TEST_CASE("variances are recovered from outputs drawn with them") {
    const std::uint64_t seed = GENERATE(21U, 22U, 23U);
    CAPTURE(seed);
    LinearModel model(seed, 400);
    const VectorXd truth{{std::log(0.3), std::log(2.0), std::log(7.0)}};
    model.draw(truth, 4.0);
    const auto best = tools::best_variances(model.statistics(), PhysicsPrior::shared);
    REQUIRE(best);
    for (Index k = 0; k < 3; ++k) { // the standard deviation of the logarithm is sqrt(2 / N) = 0.07
        CHECK(std::abs(std::log(best->output_variance[k]) - truth[k]) < 4 * 0.071);
    }
    CHECK(std::abs(std::log(best->prior_variance[0] / 4.0)) < 4 * std::sqrt(2.0 / LinearModel::columns));
}

TEST_CASE("for nearly collinear columns the result is a minimum or there is none") {
    const auto prior = GENERATE(PhysicsPrior::none, PhysicsPrior::shared, PhysicsPrior::diagonal);
    const double difference = GENERATE(1e-3, 1e-5, 1e-6, 1e-7, 1e-8);
    const std::uint64_t seed = dfdyn::tests::seed() + GENERATE(range(0U, 10U));
    CAPTURE(static_cast<int>(prior), difference, seed);
    LinearModel model(seed);
    for (Index k = 0; k < LinearModel::outputs; ++k) {
        model.psi.col(k * LinearModel::columns + 1) =
            model.psi.col(k * LinearModel::columns) + difference * model.random.matrix(12, 1);
    }
    model.y *= 1e3;
    const auto best = tools::best_variances(model.statistics(), prior);
    CHECK((best || difference < 1e-4));
    if (best) { // the priors may be at their bounds
        CHECK(best->at.gradient.head(LinearModel::outputs).cwiseAbs().maxCoeff() < 1e-6 * 12);
    }
}

TEST_CASE("equal columns leave least squares without a solution unless there is a prior") {
    LinearModel model(dfdyn::tests::seed());
    for (Index k = 0; k < LinearModel::outputs; ++k) {
        model.psi.col(k * LinearModel::columns + 1) = model.psi.col(k * LinearModel::columns);
        model.psi.col(k * LinearModel::columns + 2).setZero();
    }
    CHECK_FALSE(tools::best_variances(model.statistics(), PhysicsPrior::none));
    CHECK(tools::best_variances(model.statistics(), PhysicsPrior::shared));
}

// The paper's proposition on SPK and SP with the mean of the parameters.
TEST_CASE(
    "as gamma grows the estimators of SPK and SP coincide and their likelihoods differ by a determinant") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const LinearModel model(dfdyn::tests::seed());
    const VectorXd log_variances = some_variances(PhysicsPrior::none);
    const auto mean = tools::variance_criterion(model.statistics(), PhysicsPrior::none, log_variances);
    const MatrixXd covariance = model.stacked_covariance(log_variances); // R
    const MatrixXd psi = model.stacked_columns();
    const MatrixXd information = psi.transpose() * covariance.llt().solve(psi);
    const double determinant = 2 * MatrixXd(information.llt().matrixL()).diagonal().array().log().sum();
    double last_estimate = 1e300;
    double last_likelihood = 1e300;
    for (const double log_gamma_square : {5.0, 10.0, 15.0}) {
        VectorXd x(log_variances.size() + 1);
        x << log_variances, log_gamma_square;
        const auto kernel = tools::variance_criterion(model.statistics(), PhysicsPrior::shared, x);
        const double estimate = (kernel->parameters - mean->parameters).norm();
        const double likelihood =
            std::abs(kernel->value - mean->value - LinearModel::columns * log_gamma_square - determinant);
        CHECK(estimate < last_estimate / 50); // in proportion to gamma^-2: e^-5 = 1/148
        CHECK(likelihood < last_likelihood / 50);
        last_estimate = estimate;
        last_likelihood = likelihood;
    }
    CHECK(last_estimate < 1e-5 * mean->parameters.norm());
    CHECK(last_likelihood < 1e-4);
    CHECK(std::abs(determinant) > 0.1); // the term by which they differ
}

} // namespace variance_components_test
