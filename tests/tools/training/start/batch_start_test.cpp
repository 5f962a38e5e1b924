// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/start/batch_start.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/random_features.hpp"

#include <cmath>
#include <limits>

namespace batch_start_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 3;
constexpr int features = 12;

/// A model with invented constants, and its start rows, which fill more than two blocks.
struct Problem {
    tools::NormalSource random{dfdyn::tests::seed()};
    tools::TrainingData data = dfdyn::tests::arm_data(700, 2, 3, random);
    tools::RowList rows = dfdyn::tests::rows_between(lags, 700);
    tools::TrainedModel model;

    explicit Problem(double forgetting_factor) {
        const tools::LagSpread spread(data.positions, rows, lags);
        const auto input = tools::lag_input(data.positions, rows, spread,
                                            dfdyn::tests::row_family(tools::InputKind::DFSR, lags));
        model.input = input->model(input->start(0, random));
        model.input.lags = lags;
        model.features = tools::draw_features(features, 6, true, 2, 1);
        model.outputs.offset = {2, 3, 4};
        model.outputs.noise_std = {0.1, 0.2, 0.3};
        model.outputs.prior_variance = 50;
        model.forgetting_factor = forgetting_factor;
    }

    MatrixXd regressors() const {
        return tools::random_features(model.features, tools::stored_inputs(model.input, data, rows));
    }

    double weight_of(std::size_t row) const {
        return std::pow(model.forgetting_factor, static_cast<double>(rows.size() - 1 - row));
    }
};

MatrixXd unit_upper(const tools::StartModel& start, Index size) {
    MatrixXd upper = MatrixXd::Identity(size, size);
    std::size_t next = 0;
    for (Index column = 0; column < size; ++column) {
        for (Index row = 0; row < column; ++row) {
            upper(row, column) = start.unit_upper.at(next++);
        }
    }
    CHECK(next == start.unit_upper.size());
    return upper;
}

TEST_CASE("the factors U D U' of the start are the inverse of the information matrix") {
    const double forgetting_factor = GENERATE(1.0, 0.995);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(forgetting_factor);
    const Problem problem(forgetting_factor);
    const tools::StartModel start = tools::batch_start(problem.model, problem.data, problem.rows);
    const MatrixXd regressors = problem.regressors();
    MatrixXd information = problem.weight_of(0) / 50 * MatrixXd::Identity(2 * features, 2 * features);
    for (Index t = 0; t < regressors.rows(); ++t) {
        information += problem.weight_of(static_cast<std::size_t>(t)) * regressors.row(t).transpose() *
                       regressors.row(t);
    }
    const MatrixXd upper = unit_upper(start, 2 * features);
    const VectorXd diagonal = Eigen::Map<const VectorXd>(start.diagonal.data(), 2 * features);
    const MatrixXd covariance = upper * diagonal.asDiagonal() * upper.transpose();
    const MatrixXd truth = tools::inverse_matrix(information);
    CHECK((covariance - truth).norm() < 1e-10 * truth.norm());
}

TEST_CASE("the weights of the start are the least-squares solution") {
    const double forgetting_factor = GENERATE(1.0, 0.995);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(forgetting_factor);
    const Problem problem(forgetting_factor);
    const tools::StartModel start = tools::batch_start(problem.model, problem.data, problem.rows);
    const Index samples = static_cast<Index>(problem.rows.size());
    MatrixXd design(samples + 2 * features, 2 * features);
    design << problem.regressors(),
        std::sqrt(problem.weight_of(0) / 50) * MatrixXd::Identity(2 * features, 2 * features);
    for (Index t = 0; t < samples; ++t) {
        design.row(t) *= std::sqrt(problem.weight_of(static_cast<std::size_t>(t)));
    }
    for (Index k = 0; k < 3; ++k) {
        VectorXd target = VectorXd::Zero(design.rows());
        for (Index t = 0; t < samples; ++t) {
            const auto index = static_cast<std::size_t>(t);
            target[t] = std::sqrt(problem.weight_of(index)) *
                        (problem.data.outputs(problem.rows[index], k) -
                         problem.model.outputs.offset[static_cast<std::size_t>(k)]) /
                        problem.model.outputs.noise_std[static_cast<std::size_t>(k)];
        }
        const VectorXd truth = tools::least_squares(design, target);
        const VectorXd found =
            Eigen::Map<const VectorXd>(start.weights.data() + k * 2 * features, 2 * features);
        CHECK((found - truth).norm() < 1e-9 * truth.norm());
    }
}

TEST_CASE("the start is finite even if forgetting removes the prior") {
    Problem problem(0.9);
    problem.data.positions.bottomRows(400).setZero(); // the arm also rests at the end
    const tools::StartModel start = tools::batch_start(problem.model, problem.data, problem.rows);
    const Eigen::Map<const VectorXd> diagonal(start.diagonal.data(), 2 * features);
    CHECK(diagonal.allFinite());
    CHECK(diagonal.minCoeff() > 0);
    CHECK(diagonal.maxCoeff() <= 1.001e6 * 50); // variance of the prior divided by its remaining weight
}

TEST_CASE("a start with a singular information matrix is rejected with its prior variance") {
    Problem problem(1);
    problem.model.outputs.prior_variance = std::numeric_limits<double>::infinity(); // none
    problem.rows.resize(features); // for twice as many weights
    CHECK_THROWS_WITH(
        tools::batch_start(problem.model, problem.data, problem.rows),
        "training: the initial state cannot be computed: expected a positive definite information "
        "matrix, found another (prior variance inf); use fewer features or a longer memory, or record "
        "more motion");
}

} // namespace batch_start_test
