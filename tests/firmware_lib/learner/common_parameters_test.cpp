// SPDX-License-Identifier: Apache-2.0
// Parameters common to several outputs. Learning the rows of a sample one after another equals the batch
// solution.
#include "dfdyn/learner/common_parameters.hpp"

#include "tests/firmware_lib/support/regression.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <algorithm>
#include <cmath>

namespace common_parameters_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The rows of a sample follow one another in the regression.
struct Instants {
    Regression regression;
    int outputs;

    [[nodiscard]] int count() const { return regression.row_count() / outputs; }
    [[nodiscard]] MatrixXd rows(int t) const {
        return regression.rows.middleRows(t * outputs, outputs).transpose(); // stored row by row
    }
    [[nodiscard]] VectorXd targets(int t) const {
        return regression.targets.col(0).segment(t * outputs, outputs);
    }
};

/// The batch solution with forgetting once per sample: the weight of a row is λ^(samples since).
BatchSolution batch(const Instants& instants, double lambda) {
    Regression weighted = instants.regression;
    const int count = instants.count();
    for (int row = 0; row < weighted.row_count(); ++row) {
        const double root = std::pow(lambda, 0.5 * (count - 1 - row / instants.outputs));
        weighted.rows.row(row) *= root;
        weighted.targets.row(row) *= root;
    }
    weighted.prior_variance /= std::pow(lambda, count - 1);
    BatchSolution solution = solve_by_qr(weighted);
    solution.information_root *= std::sqrt(lambda);
    return solution;
}

constexpr int parameters = 10;

/// Prior variance 10, far below the ceiling under forgetting, which has its own test.
const LearnerStart<double, parameters, 1>& start_below_ceiling() {
    static const auto start = [] {
        LearnerStart<double, parameters, 1> zeros{};
        std::ranges::fill(zeros.diagonal, 10);
        return zeros;
    }();
    return start;
}

using Shared = CommonParameters<double, parameters, dynamic>;

TEST_CASE("common parameters equal the batch solution, with forgetting once per sample") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int outputs : {1, 2, 6}) {
        for (const double lambda : {1.0, 0.99}) {
            const RegressionSize size{50 * outputs, parameters, 1};
            const Instants instants{with_prior(random_regression(engine, size, Columns::independent), 10, 1),
                                    outputs};
            const LearnerConstants<double, parameters, 1> constants{1000, lambda, &start_below_ceiling()};
            Shared learner(constants, {}, {outputs});
            VectorXd last_variances(outputs);
            for (int t = 0; t < instants.count(); ++t) {
                learner.variances(instants.rows(t).data(), last_variances.data());
                learner.begin(instants.rows(t).data(), instants.targets(t).data(), 1);
                Budget budget = Budget::unlimited();
                REQUIRE(learner.advance(budget));
                for (int k = 0; k < outputs; ++k) {
                    REQUIRE(learner.last_variances()[k] == last_variances[k]);
                }
            }
            const BatchSolution truth = batch(instants, lambda);
            const Eigen::Map<const VectorXd> learned(learner.parameters(), parameters);
            CAPTURE(outputs, lambda);
            CHECK(relative_error(learned, truth.weights) < 1e-9);
            VectorXd variances(parameters);
            for (int i = 0; i < parameters; ++i) {
                variances[i] = learner.learner().parameter_variance(i);
            }
            CHECK(largest_relative_error(variances, truth.parameter_variances()) < 1e-9);
        }
    }
}

TEST_CASE("the rows of a sample are weighted by its noise") {
    DFDYN_SEEDED_ENGINE(engine);
    const Regression regression =
        with_prior(random_regression(engine, {40, parameters, 1}, Columns::independent), 10, 1);
    const LearnerConstants<double, parameters, 1> constants{1000, 1, &start_below_ceiling()};
    Shared learner(constants, {}, {2});
    Regression weighted = regression;
    for (int t = 0; t < 20; ++t) {
        const double noise_variance = 1 + 0.3 * t;
        weighted.rows.middleRows(2 * t, 2) /= std::sqrt(noise_variance);
        weighted.targets.middleRows(2 * t, 2) /= std::sqrt(noise_variance);
        const MatrixXd rows = regression.rows.middleRows(2 * t, 2).transpose();
        const VectorXd targets = regression.targets.middleRows(2 * t, 2);
        learner.begin(rows.data(), targets.data(), noise_variance);
        Budget budget = Budget::unlimited();
        learner.advance(budget);
    }
    const Eigen::Map<const VectorXd> learned(learner.parameters(), parameters);
    CHECK(relative_error(learned, solve_by_qr(weighted).weights) < 1e-9);
}

} // namespace common_parameters_test
