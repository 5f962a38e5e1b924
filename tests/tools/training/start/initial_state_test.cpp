// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/start/initial_state.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/base/text/error.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/random_features.hpp"

#include <Eigen/LU>

#include <cmath>

namespace initial_state_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 3;
constexpr Index features = 12; // columns of 6 frequencies
constexpr Index outputs = 3;
constexpr Index parameters = 5;
constexpr double kernel_variance = 50; // of the weights

/// A model with invented constants and columns, solved for all unknowns [w_1 ... w_m, pi] at once.
struct Problem {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = dfdyn::tests::arm_data(400, 2, outputs, random);
    tools::RowList rows = dfdyn::tests::rows_between(lags, 400);
    tools::TrainedModel model;
    MatrixXd columns = random.matrix(397, outputs* parameters);
    tools::ParameterPrior prior = tools::ParameterPrior::independent(parameters, 2.5);

    explicit Problem(double forgetting_factor) {
        const tools::LagSpread spread(data.positions, rows, lags);
        const auto input = tools::lag_input(data.positions, rows, spread,
                                            dfdyn::tests::row_family(tools::InputKind::DFSR, lags));
        model.input = input->model(input->start(0, random));
        model.input.lags = lags;
        model.features = tools::draw_features(features / 2, 6, true, 2, 1);
        model.outputs.offset = {0, 0, 0};
        model.outputs.noise_std = {0.1, 0.2, 0.3};
        model.outputs.prior_variance = kernel_variance;
        model.forgetting_factor = forgetting_factor;
    }

    tools::PhysicsProblem physics() const { return {model, data, rows, columns}; }

    double noise(Index k) const { return model.outputs.noise_std[static_cast<std::size_t>(k)]; }

    VectorXd weights() const {
        VectorXd result(397);
        for (Index t = 0; t < 397; ++t) {
            result[t] = std::pow(model.forgetting_factor, static_cast<double>(396 - t));
        }
        return result;
    }

    /// Sets a prior with a mean and correlations.
    void know() {
        const MatrixXd root = random.matrix(parameters, parameters);
        prior = {random.matrix(parameters, 1),
                 root * root.transpose() + MatrixXd::Identity(parameters, parameters)};
    }

    MatrixXd regressors() const {
        return tools::random_features(model.features, tools::stored_inputs(model.input, data, rows));
    }

    /// Sum over outputs and rows of the weighted squares of [phi in block k, psi~], plus the priors.
    MatrixXd information(bool kernel, bool physics) const {
        const Index size = outputs * features + parameters;
        MatrixXd sum = MatrixXd::Zero(size, size);
        sum.diagonal().setConstant(weights()[0] / kernel_variance);
        sum.bottomRightCorner(parameters, parameters) = weights()[0] * prior.information;
        for (Index k = 0; k < outputs; ++k) {
            const MatrixXd row = design(k, kernel, physics);
            sum += row.transpose() * weights().asDiagonal() * row;
        }
        return sum;
    }

    VectorXd right_hand_side(bool kernel, bool physics) const {
        VectorXd sum = VectorXd::Zero(outputs * features + parameters);
        if (physics) {
            sum.tail(parameters) = weights()[0] * prior.information * prior.mean;
        }
        for (Index k = 0; k < outputs; ++k) {
            const VectorXd y = data.outputs(rows, k) / noise(k);
            sum += design(k, kernel, physics).transpose() * weights().asDiagonal() * y;
        }
        return sum;
    }

    MatrixXd design(Index k, bool kernel, bool physics) const {
        MatrixXd row = MatrixXd::Zero(397, outputs * features + parameters);
        if (kernel) {
            row.middleCols(k * features, features) = regressors();
        }
        if (physics) {
            row.rightCols(parameters) = columns.middleCols(k * parameters, parameters) / noise(k);
        }
        return row;
    }
};

/// The product U D U'.
MatrixXd covariance(const std::vector<double>& unit_upper, const std::vector<double>& diagonal) {
    const auto size = static_cast<Index>(diagonal.size());
    MatrixXd upper = MatrixXd::Identity(size, size);
    std::size_t next = 0;
    for (Index column = 0; column < size; ++column) {
        for (Index row = 0; row < column; ++row) {
            upper(row, column) = unit_upper.at(next++);
        }
    }
    return upper * Eigen::Map<const VectorXd>(diagonal.data(), size).asDiagonal() * upper.transpose();
}

double error_of(const MatrixXd& found, const MatrixXd& truth) {
    return (found - truth).norm() / truth.norm();
}

TEST_CASE("the start of SPK in block-arrow form is the solution for all unknowns") {
    const double forgetting_factor = GENERATE(1.0, 0.995);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(forgetting_factor);
    Problem problem(forgetting_factor);
    if (GENERATE(false, true)) {
        problem.know();
    }
    const tools::InitialState start = tools::joint_initial_state(problem.physics(), problem.prior);
    const MatrixXd inverse = tools::inverse_matrix(problem.information(true, true));
    const VectorXd truth = inverse * problem.right_hand_side(true, true);
    CHECK(error_of(start.physics.parameters, truth.tail(parameters)) < 1e-9);
    const MatrixXd physics = covariance(start.physics.unit_upper, start.physics.diagonal);
    CHECK(error_of(physics, inverse.bottomRightCorner(parameters, parameters)) < 1e-9);
    const MatrixXd kernel = covariance(start.kernel.unit_upper, start.kernel.diagonal);
    REQUIRE(start.physics.coupling.size() == outputs);
    for (Index k = 0; k < outputs; ++k) {
        const MatrixXd& coupling = start.physics.coupling[static_cast<std::size_t>(k)];
        const auto alone = Eigen::Map<const VectorXd>(start.kernel.weights.data() + k * features, features);
        CHECK(error_of(alone - coupling * start.physics.parameters, truth.segment(k * features, features)) <
              1e-9);
        CHECK(error_of(kernel + coupling * physics * coupling.transpose(),
                       inverse.block(k * features, k * features, features, features)) < 1e-9);
        CHECK(error_of(-coupling * physics,
                       inverse.block(k * features, outputs * features, features, parameters)) < 1e-9);
    }
}

TEST_CASE("the start of P is the solution of ridge regression") {
    const double forgetting_factor = GENERATE(1.0, 0.995);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(forgetting_factor);
    Problem problem(forgetting_factor);
    if (GENERATE(false, true)) {
        problem.know();
    }
    const tools::InitialState start = tools::parametric_start(problem.physics(), problem.prior);
    const MatrixXd inverse = tools::inverse_matrix(problem.information(false, true));
    CHECK(error_of(start.physics.parameters,
                   (inverse * problem.right_hand_side(false, true)).tail(parameters)) < 1e-9);
    CHECK(error_of(covariance(start.physics.unit_upper, start.physics.diagonal),
                   inverse.bottomRightCorner(parameters, parameters)) < 1e-9);
    CHECK(start.kernel.weights.empty());
}

TEST_CASE("the start of SP and SP2 is the start of NP on the residual") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Problem problem(1);
    const VectorXd pi = problem.random.matrix(parameters, 1);
    const tools::InitialState start = tools::residual_start(problem.physics(), pi);
    const VectorXd target =
        problem.right_hand_side(true, false) - [&] { // cross products of the design with the known part
            VectorXd sum = VectorXd::Zero(outputs * features + parameters);
            for (Index k = 0; k < outputs; ++k) {
                const VectorXd known = problem.design(k, false, true).rightCols(parameters) * pi;
                sum += problem.design(k, true, false).transpose() * known;
            }
            return sum;
        }();
    const VectorXd truth = problem.information(true, false).fullPivLu().solve(target);
    const auto found = Eigen::Map<const VectorXd>(start.kernel.weights.data(), outputs * features);
    CHECK(error_of(found, truth.head(outputs * features)) < 1e-9);
    CHECK(start.physics.parameters == pi);
    CHECK(start.physics.diagonal.empty());
}

TEST_CASE("a start whose equations cannot be solved is an error") {
    Problem problem(1);
    problem.columns(3, 2) = std::nan("");
    CHECK_THROWS_AS(tools::joint_initial_state(problem.physics(), problem.prior), tools::InputError);
    CHECK_THROWS_AS(tools::parametric_start(problem.physics(), problem.prior), tools::InputError);
}

} // namespace initial_state_test
