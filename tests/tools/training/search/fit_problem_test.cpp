// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/fit_problem.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tests/tools/training/synthetic_physics.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>
#include <string>

namespace fit_problem_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::InputKind;
using tools::PhysicsPrior;

/// A small training problem with physics of five columns for two outputs and two joints.
struct Problem {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = noisy(dfdyn::tests::arm_data(120, 2, 2, random));
    dfdyn::tests::SyntheticRegressor regressor{2, 2, 5, random};
    tools::TrainingOptions options;

    Problem(InputKind input, tools::PhysicsMotion motion) {
        options.input = input;
        options.lags = 4;
        options.feature_count = 10;
        options.likelihood_rows = 40;
        options.physics.regressor = &regressor;
        options.physics.motion = motion;
    }

    tools::TrainingData noisy(tools::TrainingData clean) {
        clean.positions += 1e-3 * random.matrix(120, 2); // so that the rows of the filters matter
        return clean;
    }
};

tools::FitModel model_of(const tools::TrainingSetup& setup, const std::string& name) {
    tools::FitModel model;
    model.kernel = name.front() != 'P';
    model.offset = VectorXd::Constant(2, name == "NP" ? 3 : 0);
    if (name != "NP") {
        model.columns = tools::choose_columns(setup);
    }
    if (name.find("D") != std::string::npos) {
        model.prior = PhysicsPrior::diagonal;
    } else if (name == "P" || name == "SPK") {
        model.prior = PhysicsPrior::shared;
    }
    return model;
}

void check_gradient(const tools::Likelihood& likelihood, const VectorXd& theta) {
    const auto value = likelihood.evaluate(theta);
    REQUIRE(value);
    const auto value_at = [&](const VectorXd& at) {
        return likelihood.evaluate(at)->minus_two_log_likelihood;
    };
    // Where two variances of the prior are equally likely the value has a kink. A longer step may cross it.
    const VectorXd truth = dfdyn::tests::differences(value_at, theta, 1e-4);
    if (truth.isZero(0)) { // physics alone does not depend on the gains of the input
        CHECK(value->gradient.isZero(0));
    } else {
        CHECK(dfdyn::tests::relative_error(value->gradient, truth) < 2e-6);
    }
}

TEST_CASE("the gradients of all models with all inputs equal finite differences") {
    const std::string name = GENERATE("NP", "P", "PD", "SP", "SPK", "SPKD");
    const auto input = GENERATE(from_range(dfdyn::tests::all_inputs()));
    const auto motion =
        GENERATE(tools::PhysicsMotion::free, tools::PhysicsMotion::poles, tools::PhysicsMotion::of_input);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(name, static_cast<int>(input), static_cast<int>(motion));
    Problem problem(input, motion);
    const tools::TrainingSetup setup(problem.data, problem.options);
    const tools::FitModel model = model_of(setup, name);
    const tools::FitProblem fit(setup, input, setup.rows.likelihood, model);
    VectorXd theta = fit.start(1);
    theta += 0.2 * problem.random.matrix(theta.size(), 1);
    if (theta.size() > 0) {
        check_gradient(fit.exact(), theta);
        check_gradient(*tools::FitProblem(setup, input, setup.rows.usable, model).running(), theta);
    }
}

TEST_CASE("the likelihood with coupled physics and motion and kernel is the normal density") {
    const std::string name = GENERATE("SP", "SPK", "P");
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(name);
    Problem problem(InputKind::DFSR, tools::PhysicsMotion::of_input);
    const tools::TrainingSetup setup(problem.data, problem.options);
    const tools::FitModel model = model_of(setup, name);
    const tools::FitProblem fit(setup, InputKind::DFSR, setup.rows.likelihood, model);
    const VectorXd theta = fit.start(2);
    const auto value = fit.exact().evaluate(theta);
    REQUIRE(value);
    const tools::Hyperparameters hyper = fit.split(theta);
    const MatrixXd inputs = fit.input().inputs(hyper.input);
    const Index samples = inputs.rows();
    const MatrixXd columns =
        setup.physics(InputKind::DFSR, setup.rows.likelihood, *model.columns)->evaluate(hyper.input);
    const Index p = columns.cols() / 2;
    MatrixXd covariance = MatrixXd::Zero(2 * samples, 2 * samples);
    MatrixXd stacked(2 * samples, p);
    for (Index k = 0; k < 2; ++k) {
        stacked.middleRows(k * samples, samples) = columns.middleCols(k * p, p);
        for (Index s = 0; s < samples; ++s) {
            for (Index t = 0; t < samples; ++t) {
                const double square = (inputs.row(s) - inputs.row(t)).squaredNorm();
                const double kernel =
                    name == "P" ? 0 : std::exp(-square / (2 * hyper.length_scale * hyper.length_scale));
                const double noise = s == t ? (name == "P" ? 1 : hyper.noise_ratio) : 0;
                covariance(k * samples + s, k * samples + t) = value->output_variance[k] * (kernel + noise);
            }
        }
    }
    VectorXd outputs = setup.outputs(setup.rows.likelihood).reshaped();
    if (name == "SP") {
        outputs -= stacked * value->physics.parameters;
    } else {
        covariance += stacked * value->physics.prior_variance.asDiagonal() * stacked.transpose();
    }
    const Eigen::LLT<MatrixXd> factor(covariance);
    const double expected = static_cast<double>(2 * samples) * std::log(2 * std::numbers::pi) +
                            2 * MatrixXd(factor.matrixL()).diagonal().array().log().sum() +
                            outputs.dot(factor.solve(outputs));
    CHECK(value->minus_two_log_likelihood == Approx(expected).epsilon(1e-8));
}

// The paper's filters are truncated after lag M; those of the physics are exact for ramps and parabolas. They
// agree up to beta^(M-1), which is 1.5e-8 here.
TEST_CASE("DFR can start from DFSR's optimum if its physics shares rows with the input") {
    const std::string name = GENERATE("P", "SP", "SPK", "SPKD");
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(name);
    Problem problem(InputKind::DFR, tools::PhysicsMotion::of_input);
    const tools::TrainingSetup setup(problem.data, problem.options);
    const tools::FitModel model = model_of(setup, name);
    const tools::FitProblem free(setup, InputKind::DFR, setup.rows.likelihood, model);
    const tools::FitProblem structured(setup, InputKind::DFSR, setup.rows.likelihood, model);
    VectorXd theta = structured.start(1);
    theta += 0.3 * problem.random.matrix(theta.size(), 1);
    theta.segment(name == "P" ? 2 : 4, 2).setConstant(-6);
    const VectorXd from = free.start_from(structured, theta);
    const tools::Bounds bounds = free.bounds();
    CHECK((from.array() >= bounds.lower.array()).all());
    CHECK((from.array() <= bounds.upper.array()).all());
    CHECK(free.exact().evaluate(from)->minus_two_log_likelihood ==
          Approx(structured.exact().evaluate(theta)->minus_two_log_likelihood).epsilon(1e-5));
}

TEST_CASE("DFR can start from DFSR's optimum with equal kernel and likelihood") {
    const std::string name = GENERATE("NP", "SPK");
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(name);
    Problem problem(InputKind::DFR, tools::PhysicsMotion::free);
    const tools::TrainingSetup setup(problem.data, problem.options);
    const tools::FitModel model = model_of(setup, name);
    const tools::FitProblem free(setup, InputKind::DFR, setup.rows.likelihood, model);
    const tools::FitProblem structured(setup, InputKind::DFSR, setup.rows.likelihood, model);
    VectorXd theta = structured.start(1);
    theta += 0.3 * problem.random.matrix(theta.size(), 1);
    CHECK(free.exact().evaluate(free.start_from(structured, theta))->minus_two_log_likelihood ==
          Approx(structured.exact().evaluate(theta)->minus_two_log_likelihood).epsilon(1e-9));
}

} // namespace fit_problem_test
