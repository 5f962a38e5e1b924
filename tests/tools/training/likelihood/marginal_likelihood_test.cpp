// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/marginal_likelihood.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/training/data/input_map.hpp"

#include <cmath>
#include <limits>
#include <string>

namespace marginal_likelihood_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 5;

/// A small training problem with scales from all rows and a likelihood of every ninth row.
struct Problem {
    tools::NormalSource random;
    tools::TrainingData data;
    tools::RowList rows = dfdyn::tests::rows_between(lags, 250, 9);
    std::unique_ptr<tools::InputMap> input;
    MatrixXd outputs;

    Problem(const std::string& kind, std::uint64_t seed) : random(seed) {
        data = dfdyn::tests::arm_data(250, 3, 2, random);
        data.positions += 1e-3 * random.matrix(250, 3); // so that the rows differ from exact derivatives
        data.positions.col(1).setConstant(-0.4);
        const tools::RowList all = dfdyn::tests::rows_between(lags, 250);
        const tools::LagSpread spread(data.positions, all, lags);
        input = kind == "STD" ? tools::derivative_input(data, rows, all, spread, true)
                              : tools::lag_input(data.positions, rows, spread, family(kind, spread));
        outputs = data.outputs(rows, Eigen::all);
        outputs.rowwise() -= outputs.colwise().mean().eval();
    }

    static std::unique_ptr<tools::RowFamily> family(const std::string& kind, const tools::LagSpread& spread) {
        if (kind == "DF") {
            return dfdyn::tests::row_family(tools::InputKind::DF, lags);
        }
        if (kind == "DFW") {
            return dfdyn::tests::row_family(tools::InputKind::DFW, lags);
        }
        if (kind == "DFSR") {
            return dfdyn::tests::row_family(tools::InputKind::DFSR, lags);
        }
        return dfdyn::tests::row_family(tools::InputKind::DFR, lags, kind.back() - '0',
                                        spread.pooled_factor());
    }
};

TEST_CASE("the gradient of the marginal likelihood equals finite differences for every input") {
    const std::string kind = GENERATE("STD", "DF", "DFW", "DFSR", "DFR1", "DFR2", "DFR3", "DFR5");
    const std::uint64_t seed = dfdyn::tests::seed() + GENERATE(0U, 1U, 2U);
    CAPTURE(kind, seed);
    Problem problem(kind, seed);
    const tools::ProfiledVarianceLikelihood outputs(problem.outputs);
    const tools::MarginalLikelihood likelihood(*problem.input, outputs);
    VectorXd theta = likelihood.start(5, problem.random);
    theta.head(2) += 0.5 * problem.random.matrix(2, 1);
    const auto value_at = [&](const VectorXd& at) {
        return likelihood.evaluate(at)->minus_two_log_likelihood;
    };
    const auto value = likelihood.evaluate(theta);
    REQUIRE(value);
    CHECK(dfdyn::tests::relative_error(value->gradient, dfdyn::tests::differences(value_at, theta, 1e-3)) <
          1e-6);
}

TEST_CASE("the marginal likelihood is the normal density of the outputs with kernel plus noise") {
    const std::string kind = GENERATE("STD", "DFR3");
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Problem problem(kind, dfdyn::tests::seed());
    const tools::ProfiledVarianceLikelihood outputs(problem.outputs);
    const tools::MarginalLikelihood likelihood(*problem.input, outputs);
    const VectorXd theta = likelihood.start(3, problem.random);
    const tools::Hyperparameters parameters = likelihood.split(theta);
    const MatrixXd inputs = problem.input->inputs(parameters.input);
    MatrixXd covariance(inputs.rows(), inputs.rows());
    for (Eigen::Index s = 0; s < inputs.rows(); ++s) {
        for (Eigen::Index t = 0; t < inputs.rows(); ++t) {
            const double distance = (inputs.row(s) - inputs.row(t)).norm() / std::exp(theta[1]);
            covariance(s, t) = std::exp(-0.5 * distance * distance) + (s == t ? std::exp(theta[0]) : 0);
        }
    }
    const auto value = likelihood.evaluate(theta);
    double expected = 0;
    for (Eigen::Index k = 0; k < problem.outputs.cols(); ++k) {
        expected +=
            dfdyn::tests::log_normal_density(problem.outputs.col(k), value->output_variance[k] * covariance);
    }
    CHECK(-0.5 * value->minus_two_log_likelihood == Approx(expected).epsilon(1e-9));
}

TEST_CASE("the marginal likelihood has no value if it cannot be computed") {
    Problem problem("DFSR", dfdyn::tests::seed());
    SECTION("outputs beyond doubles") {
        const tools::ProfiledVarianceLikelihood outputs(1e200 * problem.outputs);
        const tools::MarginalLikelihood likelihood(*problem.input, outputs);
        CHECK_FALSE(likelihood.evaluate(likelihood.start(0, problem.random)));
    }
    SECTION("a parameter that is not a number") {
        const tools::ProfiledVarianceLikelihood outputs(problem.outputs);
        const tools::MarginalLikelihood likelihood(*problem.input, outputs);
        VectorXd theta = likelihood.start(0, problem.random);
        theta[2] = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(likelihood.evaluate(theta));
    }
    SECTION("no noise and a kernel of ones") {
        const tools::ProfiledVarianceLikelihood outputs(problem.outputs);
        const tools::MarginalLikelihood likelihood(*problem.input, outputs);
        VectorXd theta = likelihood.start(0, problem.random);
        theta[0] = -1000;
        theta[1] = 50;
        CHECK_FALSE(likelihood.evaluate(theta));
    }
}

TEST_CASE("each bound that the kernel's parameters reached is named, and no other") {
    using Catch::Matchers::StartsWith;
    using dfdyn::tools::bounds_reached;
    CHECK(bounds_reached(0.002, 3).empty());
    CHECK(bounds_reached(0.002, 980).empty());
    CHECK_THAT(bounds_reached(0.002, 0.01).at(0), StartsWith("the length scale is at its lower bound"));
    CHECK_THAT(bounds_reached(0.002, 999.9).at(0), StartsWith("the length scale is at its upper bound"));
    CHECK_THAT(bounds_reached(1e-6, 3).at(0), StartsWith("rho^2/sigma^2 is at its upper bound"));
    CHECK_THAT(bounds_reached(100, 3).at(0), StartsWith("rho^2/sigma^2 is at its lower bound"));
    CHECK(bounds_reached(100, 1000).size() == 2);
}

} // namespace marginal_likelihood_test
