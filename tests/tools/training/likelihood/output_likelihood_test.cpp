// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/output_likelihood.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/base/numerics/random_source.hpp"
#include "tools/training/likelihood/covariance_factor.hpp"

namespace output_likelihood_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
    MatrixXd covariance;
    MatrixXd outputs;

    Problem() {
        tools::NormalSource random(dfdyn::tests::seed());
        const MatrixXd root = random.matrix(8, 8);
        covariance = root * root.transpose() + MatrixXd::Identity(8, 8);
        outputs = random.matrix(8, 3) * VectorXd::LinSpaced(3, 0.1, 10).asDiagonal();
    }

    tools::Evidence evidence(const MatrixXd& of) const {
        const tools::ProfiledVarianceLikelihood likelihood(outputs);
        return *likelihood.evaluate(*tools::CovarianceFactor::of(of), VectorXd(0));
    }

    double log_density(const VectorXd& variances) const {
        double sum = 0;
        for (Eigen::Index k = 0; k < outputs.cols(); ++k) {
            sum += dfdyn::tests::log_normal_density(outputs.col(k), variances[k] * covariance);
        }
        return sum;
    }
};

TEST_CASE("ProfiledVarianceLikelihood is the normal density at the best variances") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Problem problem;
    const tools::Evidence evidence = problem.evidence(problem.covariance);
    const double log_likelihood = -0.5 * evidence.minus_two_log_likelihood;
    CHECK(log_likelihood == Approx(problem.log_density(evidence.output_variance)).epsilon(1e-11));
    for (Eigen::Index k = 0; k < 3; ++k) {
        for (const double factor : {0.99, 1.01}) {
            VectorXd moved = evidence.output_variance;
            moved[k] *= factor;
            CHECK(problem.log_density(moved) < log_likelihood);
        }
    }
}

TEST_CASE(
    "the derivative of ProfiledVarianceLikelihood with respect to the covariance equals finite differences") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const Problem problem;
    const auto along = [&](Eigen::Index row, Eigen::Index column) {
        return dfdyn::tests::differences(
            [&](const VectorXd& change) {
                MatrixXd moved = problem.covariance;
                moved(row, column) += change[0];
                moved(column, row) = moved(row, column);
                return problem.evidence(moved).minus_two_log_likelihood;
            },
            VectorXd::Zero(1))[0];
    };
    const tools::Evidence evidence = problem.evidence(problem.covariance);
    const MatrixXd gradient =
        evidence.count * problem.covariance.inverse() -
        evidence.directions * evidence.weights.asDiagonal() * evidence.directions.transpose();
    MatrixXd expected(8, 8);
    for (Eigen::Index row = 0; row < 8; ++row) {
        for (Eigen::Index column = 0; column < 8; ++column) {
            expected(row, column) = along(row, column) / (row == column ? 1 : 2); // both entries change
        }
    }
    CHECK(dfdyn::tests::relative_error(gradient, expected) < 1e-6);
}

} // namespace output_likelihood_test
