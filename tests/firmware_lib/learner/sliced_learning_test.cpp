// SPDX-License-Identifier: Apache-2.0
// Learning in slices equals learning at once, bit for bit.
#include "dfdyn/core/budget.hpp"

#include "tests/firmware_lib/support/learner_under_test.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>

namespace sliced_learning_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Eigen::VectorXd;

constexpr int columns = 30;
constexpr int outputs = 3;

template <class Kind>
using Fixed = LearnerUnderTest<Kind, columns, outputs>;

template <class Kind>
constexpr Cost cost_of() {
    return Fixed<Kind>::Learner::cost(columns, outputs);
}

/// Learns one row with random small budgets; returns the number of steps.
template <class Learner>
int learn_in_slices(Learner& learned, const Cost& cost, std::mt19937_64& engine) {
    std::uniform_int_distribution<std::int64_t> operations(0, 2 * cost.largest_step);
    int steps = 1;
    while (!learned.advance(Budget{operations(engine)})) {
        ++steps;
    }
    return steps;
}

template <class Kind>
bool same_state(const Fixed<Kind>& a, const Fixed<Kind>& b) {
    return a.weights() == b.weights() && a.parameter_variances() == b.parameter_variances();
}

/// Few rows for many columns: variances often exceed the prior's, so that bounding them is sliced too.
Regression rows_for_slices(std::mt19937_64& engine, double forgetting_factor) {
    Regression regression = random_regression(engine, {60, columns, outputs}, Columns::independent);
    regression.rows.rightCols(columns / 2).setZero();
    return with_prior(regression, 100, forgetting_factor);
}

TEMPLATE_TEST_CASE("any sequence of budgets gives the same result, bit for bit", "", UdFloat, UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double lambda : {1.0, 0.98}) {
        const Regression regression = rows_for_slices(engine, lambda);
        Fixed<TestType> whole(columns, outputs, regression.prior_variance, lambda);
        Fixed<TestType> sliced(columns, outputs, regression.prior_variance, lambda);
        int steps = 0;
        int same = 0;
        for (int t = 0; t < regression.row_count(); ++t) {
            whole.learn(part(regression, t, t + 1));
            sliced.begin(regression.rows.row(t), regression.targets.row(t));
            steps += learn_in_slices(sliced, cost_of<TestType>(), engine);
            same += same_state<TestType>(whole, sliced) ? 1 : 0;
        }
        CAPTURE(lambda);
        CHECK(same == regression.row_count());
        CHECK(steps > regression.row_count()); // learning was sliced
    }
}

TEMPLATE_TEST_CASE("while a row is being learned, predictions are those of the last complete state", "",
                   UdFloat, UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const Regression regression = rows_for_slices(engine, 0.98);
    const double tolerance = TestType::tolerance / 10; // only rounding
    Fixed<TestType> before(columns, outputs, regression.prior_variance, 0.98);
    Fixed<TestType> during(columns, outputs, regression.prior_variance, 0.98);
    int looks = 0;
    double worst_variance = 0;
    bool same_means = true;
    for (int t = 0; t < regression.row_count(); ++t) {
        const VectorXd probe = regression.rows.row((t + 17) % regression.row_count());
        during.begin(regression.rows.row(t), regression.targets.row(t));
        while (during.learner().sample_pending()) {
            const double variance = before.variance(probe);
            worst_variance = std::max(worst_variance, std::abs(during.variance(probe) - variance) / variance);
            same_means = same_means && during.means(probe) == before.means(probe);
            during.advance(Budget{cost_of<TestType>().largest_step});
            ++looks;
        }
        during.advance(Budget::unlimited());
        before.learn(part(regression, t, t + 1));
    }
    CHECK(looks >= regression.row_count());
    CHECK(same_means);
    CHECK(worst_variance < tolerance);
}

TEMPLATE_TEST_CASE("a budget below the largest step never finishes a row, one of that size always does", "",
                   UdFloat, UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Cost cost = cost_of<TestType>();
    const Regression regression = rows_for_slices(engine, 1);
    Fixed<TestType> learned(columns, outputs, regression.prior_variance, 1);
    learned.begin(regression.rows.row(0), regression.targets.row(0));
    for (int step = 0; step < 1000; ++step) {
        learned.advance(Budget{cost.largest_step - 1});
    }
    CHECK(learned.learner().sample_pending());
    CHECK(learned.weights().isZero(0));
    const auto enough = static_cast<int>(cost.learn / cost.largest_step) * 2 + 1;
    int steps = 0;
    while (!learned.advance(Budget{cost.largest_step}) && steps <= enough) {
        ++steps;
    }
    CHECK(steps <= enough);
    CHECK_FALSE(learned.weights().isZero(0));
}

TEMPLATE_TEST_CASE("learning uses exactly its declared cost and never more than its budget", "", UdFloat,
                   UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr Cost cost = cost_of<TestType>();
    const Regression regression = rows_for_slices(engine, 1);
    Fixed<TestType> learned(columns, outputs, regression.prior_variance, 1);
    for (int t = 0; t < regression.row_count(); ++t) {
        learned.begin(regression.rows.row(t), regression.targets.row(t));
        std::int64_t spent = 0;
        while (!learned.learner().idle()) {
            Budget budget{std::uniform_int_distribution<std::int64_t>(0, 2 * cost.largest_step)(engine)};
            const std::int64_t given = budget.operations;
            learned.learner().advance(budget);
            REQUIRE(budget.operations >= 0);
            spent += given - budget.operations;
        }
        REQUIRE(spent == cost.learn);
    }
}

TEST_CASE("the costs are constant expressions of the sizes, in the documented proportion") {
    constexpr Cost ud = UdCovariance<float, 500, 6>::cost(500, 6);
    STATIC_REQUIRE(ud.learn > 3 * 500 * 500 / 2 && ud.learn < 2 * 500 * 500);
    STATIC_REQUIRE(ud.largest_step < ud.learn / 50);
    STATIC_REQUIRE(ud.variance > 500 * 500 / 2 && ud.variance < 600 * 500);
}

} // namespace sliced_learning_test
