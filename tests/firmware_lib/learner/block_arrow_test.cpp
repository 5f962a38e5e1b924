// SPDX-License-Identifier: Apache-2.0
// Model SPK by its block-arrow structure equals the dense solution of all its unknowns.
#include "dfdyn/core/snapshot.hpp"

#include "tests/firmware_lib/learner/arrow_problem.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <type_traits>
#include <vector>

namespace block_arrow_test {

template <class Scalar>
void check_equal_to_dense(const ArrowProblem& problem, double tolerance) {
    auto arrow = std::make_unique<Arrow<Scalar>>(problem);
    const int last = problem.instants() - 1;
    for (int t = 0; t < last; ++t) {
        arrow->learn(problem, t);
    }
    const DenseSolution truth(problem, last);
    CHECK(relative_error(arrow->all_unknowns(), truth.mean) < tolerance);
    const VectorXd means = arrow->predict(problem, last);
    const VectorXd variances = arrow->variances(problem, last);
    for (int k = 0; k < problem.outputs; ++k) {
        const VectorXd row = problem.dense_row(last, k);
        CAPTURE(k);
        CHECK(means[k] == Approx(row.dot(truth.mean)).margin(tolerance * means.norm()));
        CHECK(variances[k] == Approx(row.dot(truth.covariance * row)).epsilon(tolerance));
    }
}

TEST_CASE("the block arrow equals the dense solution of all unknowns, for every size") {
    DFDYN_SEEDED_ENGINE(engine);
    struct Size {
        int columns, parameters, outputs;
    };
    for (const auto& [columns, parameters, outputs] :
         {Size{1, 1, 1}, {2, 1, 3}, {4, 3, 2}, {7, 5, 1}, {16, 10, 6}, {30, 21, 4}}) {
        for (const double lambda : {1.0, 0.998}) {
            ArrowProblem problem(engine, 150, columns, parameters, outputs);
            problem.forgetting_factor = static_cast<double>(
                static_cast<float>(std::max(lambda, 1 - 1.0 / std::max(columns, parameters))));
            CAPTURE(columns, parameters, outputs, lambda);
            check_equal_to_dense<double>(problem, 1e-9);
            check_equal_to_dense<float>(problem, 2e-3);
        }
    }
}

TEST_CASE("the block arrow learned in slices equals learning at once, bit for bit") {
    DFDYN_SEEDED_ENGINE(engine);
    ArrowProblem problem(engine, 60, 12, 5, 3);
    problem.forgetting_factor = 0.95; // variances exceed their bound, which is sliced too
    const Cost cost = Arrow<double>::Learner::cost(12, 5, 3);
    Arrow<double> whole(problem);
    Arrow<double> sliced(problem);
    int steps = 0;
    for (int t = 0; t < problem.instants(); ++t) {
        whole.learn(problem, t);
        sliced.predict(problem, t);
        sliced.begin(problem, t);
        bool idle = false;
        while (!idle) {
            Budget budget{std::uniform_int_distribution<std::int64_t>(0, 2 * cost.largest_step)(engine)};
            idle = sliced.learner().advance(budget);
            REQUIRE(budget.operations >= 0);
            ++steps;
        }
        REQUIRE(whole.all_unknowns() == sliced.all_unknowns());
        REQUIRE(whole.variances(problem, t) == sliced.variances(problem, t));
    }
    CHECK(steps > 3 * problem.instants());
}

TEST_CASE("while a sample is learned in slices, predictions are those before it, after some of its rows, or "
          "after it") {
    DFDYN_SEEDED_ENGINE(engine);
    ArrowProblem problem(engine, 60, 12, 5, 1); // one output: no state between rows
    const Cost cost = Arrow<double>::Learner::cost(12, 5, 1);
    Arrow<double> whole(problem);
    Arrow<double> sliced(problem);
    int looks = 0;
    for (int t = 0; t + 7 < problem.instants(); ++t) {
        const int probe = t + 7;
        const VectorXd before = sliced.predict(problem, probe);
        const VectorXd variance_before = sliced.variances(problem, probe);
        whole.learn(problem, t);
        const VectorXd after = whole.predict(problem, probe);
        const VectorXd variance_after = whole.variances(problem, probe);
        sliced.predict(problem, t);
        sliced.begin(problem, t);
        Budget budget{cost.largest_step};
        while (!sliced.learner().advance(budget)) {
            const VectorXd during = sliced.predict(problem, probe);
            const VectorXd variance = sliced.variances(problem, probe);
            CAPTURE(t, before[0], during[0], after[0]);
            const double margin = 1e-9 * (1 + std::abs(before[0]) + std::abs(after[0]));
            REQUIRE(during[0] > std::min(before[0], after[0]) - margin);
            REQUIRE(during[0] < std::max(before[0], after[0]) + margin);
            REQUIRE(variance[0] < variance_before[0] * (1 + 1e-9));
            REQUIRE(variance[0] > variance_after[0] * (1 - 1e-9));
            budget = Budget{cost.largest_step};
            ++looks;
        }
    }
    CHECK(looks > 100);
}

TEST_CASE("reset returns to the state after construction") {
    DFDYN_SEEDED_ENGINE(engine);
    const ArrowProblem problem(engine, 30, 9, 4, 2);
    Arrow<float> used(problem);
    Arrow<float> fresh(problem);
    for (int t = 0; t < 20; ++t) {
        used.learn(problem, t);
    }
    used.learner().reset();
    std::vector<std::byte> a(snapshot_bytes(used.learner()));
    std::vector<std::byte> b(a.size());
    REQUIRE(write_snapshot(used.learner(), 1, a) == SnapshotResult::ok);
    REQUIRE(write_snapshot(fresh.learner(), 1, b) == SnapshotResult::ok);
    CHECK(a == b);
}

TEST_CASE("a sample predicted before another was learned is learned as if predicted after it") {
    DFDYN_SEEDED_ENGINE(engine);
    const ArrowProblem problem(engine, 40, 9, 4, 2);
    Arrow<double> usual(problem);
    Arrow<double> late(problem);
    for (int t = 0; t + 1 < problem.instants(); t += 2) {
        usual.learn(problem, t);
        usual.learn(problem, t + 1);
        late.predict(problem, t);
        late.begin(problem, t);
        late.predict(problem, t + 1); // while t is being learned
        Budget budget = Budget::unlimited();
        late.learner().advance(budget);
        late.begin(problem, t + 1);
        late.learner().advance(budget);
    }
    CHECK(relative_error(late.all_unknowns(), usual.all_unknowns()) < 1e-12);
}

TEST_CASE("a sample predicted during a reset of the covariance is learned as if predicted after it") {
    DFDYN_SEEDED_ENGINE(engine);
    const ArrowProblem problem(engine, 40, 9, 4, 2);
    Arrow<double> usual(problem);
    Arrow<double> sliced(problem);
    for (int t = 0; t < 30; ++t) {
        usual.learn(problem, t);
        sliced.learn(problem, t);
    }
    Budget whole = Budget::unlimited();
    usual.learner().reset_covariance();
    usual.learner().advance(whole);
    usual.learn(problem, 30);
    sliced.learner().reset_covariance();
    const Cost cost = Arrow<double>::Learner::cost(9, 4, 2);
    Budget part{cost.largest_step};
    REQUIRE_FALSE(sliced.learner().advance(part));
    sliced.predict(problem, 30);
    sliced.learner().advance(whole);
    sliced.begin(problem, 30);
    sliced.learner().advance(whole);
    CHECK(relative_error(sliced.all_unknowns(), usual.all_unknowns()) < 1e-12);
}

TEST_CASE("the block arrow uses exactly its declared cost") {
    DFDYN_SEEDED_ENGINE(engine);
    const ArrowProblem problem(engine, 20, 30, 7, 3);
    const Cost cost = Arrow<float>::Learner::cost(30, 7, 3);
    Arrow<float> arrow(problem);
    for (int t = 0; t < problem.instants(); ++t) {
        arrow.predict(problem, t);
        arrow.begin(problem, t);
        Budget budget{cost.learn - 1};
        CHECK_FALSE(arrow.learner().advance(budget));
        budget.operations += 1;
        CHECK(arrow.learner().advance(budget));
        CHECK(budget.operations == 0);
    }
}

TEST_CASE("the cost of the block arrow is the sum of its parts and far below the dense solution") {
    constexpr int columns = 500;
    constexpr int parameters = 40;
    constexpr int outputs = 6;
    constexpr Cost arrow =
        BlockArrow<float, columns, parameters, outputs>::cost(columns, parameters, outputs);
    constexpr Cost features = UdCovariance<float, columns, outputs>::cost(columns, outputs);
    constexpr std::int64_t dense =
        std::int64_t{3} * (outputs * columns + parameters) * (outputs * columns + parameters) / 2 * outputs;
    STATIC_REQUIRE(arrow.predict + arrow.learn < 2 * (features.predict + features.learn));
    STATIC_REQUIRE(100 * (arrow.predict + arrow.learn) < dense);
    STATIC_REQUIRE(arrow.largest_step < arrow.learn / 40);
}

TEMPLATE_TEST_CASE("a covariance reset keeps the predictions, in any slices", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const double tolerance = std::is_same_v<TestType, float> ? 1e-4 : 1e-12;
    const ArrowProblem problem(engine, 120, 16, 5, 3);
    auto arrow = std::make_unique<Arrow<TestType>>(problem);
    for (int t = 0; t < 110; ++t) {
        arrow->learn(problem, t);
    }
    std::vector<VectorXd> before;
    for (int t = 110; t < 120; ++t) {
        before.push_back(arrow->predict(problem, t));
    }
    using Learner = typename Arrow<TestType>::Learner;
    const Cost cost = Learner::cost(problem.columns, problem.parameters, problem.outputs);
    arrow->learner().reset_covariance();
    std::int64_t spent = 0;
    for (bool done = false; !done;) {
        Budget budget{cost.largest_step};
        done = arrow->learner().advance(budget);
        spent += cost.largest_step - budget.operations;
        REQUIRE(spent <= cost.reset_covariance);
    }
    CHECK(spent == cost.reset_covariance);
    for (int t = 110; t < 120; ++t) {
        const VectorXd after = arrow->predict(problem, t);
        CHECK(relative_error(after, before[static_cast<std::size_t>(t - 110)]) < tolerance);
        const VectorXd variances = arrow->variances(problem, t);
        for (int k = 0; k < problem.outputs; ++k) {
            const double prior = double{Arrow<TestType>::ceiling} * problem.dense_row(t, k).squaredNorm();
            CHECK(variances[k] == Approx(prior).epsilon(tolerance));
        }
    }
}

TEMPLATE_TEST_CASE("samples with another noise variance are weighted as in the dense solution", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    const double tolerance = std::is_same_v<TestType, float> ? 1e-3 : 1e-9;
    ArrowProblem problem(engine, 120, 16, 5, 3);
    auto arrow = std::make_unique<Arrow<TestType>>(problem);
    for (int t = 0; t < problem.instants(); ++t) {
        const double deviation = 1 << (engine() % 6); // exact in float
        arrow->learn(problem, t, deviation * deviation);
        problem.phi.row(t) /= deviation;
        problem.psi[static_cast<std::size_t>(t)] /= deviation;
        problem.targets.row(t) /= deviation;
    }
    const DenseSolution truth(problem, problem.instants());
    CHECK(relative_error(arrow->all_unknowns(), truth.mean) < tolerance);
}

} // namespace block_arrow_test
