// SPDX-License-Identifier: Apache-2.0
// Recursive equals batch: what every form of learner promises.
#include "dfdyn/learner/learner.hpp"

#include "tests/firmware_lib/support/learner_under_test.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/QR>

#include <array>
#include <cmath>
#include <type_traits>

namespace learner_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double no_forgetting = 1;
constexpr double some_forgetting = 0.999F;
constexpr std::array all_columns{Columns::independent, Columns::badly_scaled, Columns::collinear,
                                 Columns::fourier_features};

/// A regression, rows that it has not seen, and its solution.
struct Problem {
    Regression regression;
    MatrixXd new_rows;
    BatchSolution truth;

    Problem(std::mt19937_64& engine, RegressionSize size, Columns columns, double prior_variance,
            double lambda) {
        constexpr int new_count = 20;
        const RegressionSize all{size.rows + new_count, size.columns, size.outputs};
        const Regression whole = with_prior(random_regression(engine, all, columns), prior_variance, lambda);
        regression = part(whole, 0, size.rows);
        new_rows = whole.rows.bottomRows(new_count);
        truth = solve_by_qr(regression);
    }

    [[nodiscard]] VectorXd new_variances() const {
        return VectorXd::NullaryExpr(new_rows.rows(),
                                     [&](Eigen::Index t) { return truth.variance(new_rows.row(t)); });
    }
};

/// The learner after all rows of a regression. It starts from the prior's covariance far below its ceiling,
/// so that forgetting is never held back by the bound on the variances: that has its own test.
template <class Kind, int p = dynamic, int m = dynamic>
class Learned : public LearnerUnderTest<Kind, p, m> {
  public:
    explicit Learned(const Regression& regression)
        : LearnerUnderTest<Kind, p, m>(
              Start::prior(regression.columns(), regression.outputs(), regression.prior_variance),
              100 * regression.prior_variance, regression.forgetting_factor) {
        this->learn(regression);
    }

    [[nodiscard]] MatrixXd predictions(const MatrixXd& rows) const {
        MatrixXd result(rows.rows(), this->weights().cols());
        for (Eigen::Index t = 0; t < rows.rows(); ++t) {
            result.row(t) = this->means(rows.row(t));
        }
        return result;
    }

    [[nodiscard]] VectorXd variances(const MatrixXd& rows) const {
        return VectorXd::NullaryExpr(rows.rows(),
                                     [&](Eigen::Index t) { return this->variance(rows.row(t)); });
    }
};

/// The weights as far as they are determined, and what they predict along the rows that were learned.
template <class Kind>
void check_weights(const Problem& problem, const Learned<Kind>& learned) {
    CHECK(information_error(problem.truth, learned.weights()) < Kind::tolerance);
    const MatrixXd& rows = problem.regression.rows;
    CHECK(relative_error(learned.predictions(rows), rows * problem.truth.weights) < Kind::tolerance);
}

template <class Kind>
void check_new_predictions(const Problem& problem, const Learned<Kind>& learned) {
    const MatrixXd truth = problem.new_rows * problem.truth.weights;
    CHECK(relative_error(learned.predictions(problem.new_rows), truth) < Kind::tolerance);
}

template <class Kind>
void check_variances(const Problem& problem, const Learned<Kind>& learned) {
    const VectorXd of_parameters = problem.truth.parameter_variances();
    CHECK(largest_relative_error(learned.parameter_variances(), of_parameters) < Kind::tolerance);
    const VectorXd of_rows = problem.new_variances();
    CHECK(largest_relative_error(learned.variances(problem.new_rows), of_rows) < Kind::tolerance);
}

/// Calls `check(problem, learned)` for each kind of learner after it has learned the problem's regression.
template <class Check>
void with_each_learner(const Problem& problem, const Check& check) {
    const auto with = [&]<class Kind>(Kind) {
        CAPTURE(Kind::name);
        check(problem, Learned<Kind>(problem.regression));
    };
    with(UdDouble{});
    with(InformationDouble{});
    with(UdFloat{});
    with(InformationFloat{});
}

/// Each weight by itself: double has the digits for that even where columns are nearly the same.
template <class Kind>
void check_each_weight(const Problem& problem, const Learned<Kind>& learned) {
    if constexpr (std::is_same_v<typename Kind::Scalar, double>) {
        CHECK(relative_error(learned.weights(), problem.truth.weights) < Kind::tolerance);
    }
}

constexpr auto all_checks = [](const Problem& problem, const auto& learned) {
    check_weights(problem, learned);
    check_each_weight(problem, learned);
    check_new_predictions(problem, learned);
    check_variances(problem, learned);
};

TEST_CASE("weights and variances are those of the batch solution, for every size and kind of columns") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {1, 2, 3, 4, 5, 7, 8, 15, 16, 33, 64}) {
        for (const Columns kind : all_columns) {
            for (const double lambda : {no_forgetting, some_forgetting}) {
                CAPTURE(columns, static_cast<int>(kind), lambda);
                with_each_learner(Problem(engine, {200, columns, 1 + columns % 6}, kind, 100, lambda),
                                  all_checks);
            }
        }
    }
}

TEST_CASE("weights and variances are those of the batch solution, for hundreds of columns") {
    DFDYN_SEEDED_ENGINE(engine);
    int turn = 0;
    for (const int columns : {100, 250, 500}) {
        const Columns kind = all_columns[static_cast<std::size_t>(turn % 4)];
        const double lambda = turn % 2 == 0 ? some_forgetting : no_forgetting;
        CAPTURE(columns, static_cast<int>(kind), lambda);
        with_each_learner(Problem(engine, {columns + 100, columns, 1 + turn}, kind, 100, lambda), all_checks);
        ++turn;
    }
}

// Where columns have similar sizes and are not collinear, each weight by itself is determined, and the normal
// equations have digits enough to be a second truth.
TEST_CASE("each weight is that of the normal equations, where they can tell") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {1, 4, 10, 33, 100}) {
        const Problem problem(engine, {200, columns, 2}, Columns::independent, 100, some_forgetting);
        const NormalEquationsSolution truth = solve_by_ldlt(problem.regression);
        CAPTURE(columns);
        CHECK(relative_error(problem.truth.weights, truth.weights) < 1e-12);
        CHECK(relative_error(Learned<UdDouble>(problem.regression).weights(), truth.weights) < 1e-9);
        CHECK(relative_error(Learned<InformationDouble>(problem.regression).weights(), truth.weights) < 1e-9);
        CHECK(relative_error(Learned<UdFloat>(problem.regression).weights(), truth.weights) < 1e-3);
        CHECK(relative_error(Learned<InformationFloat>(problem.regression).weights(), truth.weights) < 1e-3);
    }
}

TEST_CASE("a weak prior costs single precision no more than a thousandth in 1,000 rows of features") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {2, 16, 100, 250}) {
        for (const double lambda : {no_forgetting, some_forgetting}) {
            CAPTURE(columns, lambda);
            const Problem problem(engine, {1000, columns, 2}, Columns::fourier_features, 1e6, lambda);
            with_each_learner(problem, [](const Problem& same, const auto& learned) {
                check_weights(same, learned);
                check_variances(same, learned);
            });
        }
    }
}

// The prior alone decides between copies of a column, and it says 1e-6 against the data's 1e3: nine digits,
// which single precision does not have for each weight. The weights as far as they are determined, and what
// they predict, are right.
TEST_CASE(
    "copies of a column under a weak prior spoil neither the predictions nor what is known of the weights") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {2, 3, 16, 33, 100}) {
        for (const double lambda : {no_forgetting, some_forgetting}) {
            CAPTURE(columns, lambda);
            const Problem problem(engine, {1000, columns, 2}, Columns::collinear, 1e6, lambda);
            with_each_learner(problem,
                              [](const Problem& same, const auto& learned) { check_weights(same, learned); });
            check_variances(problem, Learned<UdDouble>(problem.regression));
            check_variances(problem, Learned<InformationDouble>(problem.regression));
        }
    }
}

TEST_CASE("sizes that are template arguments learn the same as sizes known at run time") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto check = [&]<int p, int m>(Extent<p>, Extent<m>) {
        CAPTURE(p, m);
        const Problem problem(engine, {100, p, m}, Columns::independent, 100, some_forgetting);
        CHECK(information_error(problem.truth, Learned<UdDouble, p, m>(problem.regression).weights()) < 1e-9);
        CHECK(information_error(problem.truth, Learned<UdFloat, p, m>(problem.regression).weights()) < 1e-3);
        CHECK(information_error(problem.truth,
                                Learned<InformationDouble, p, m>(problem.regression).weights()) < 1e-9);
        CHECK(information_error(problem.truth,
                                Learned<InformationFloat, p, m>(problem.regression).weights()) < 1e-3);
    };
    check(Extent<1>{}, Extent<1>{});
    check(Extent<4>{}, Extent<3>{});
    check(Extent<13>{}, Extent<6>{});
}

TEMPLATE_TEST_CASE("a start equals having learned the rows that made it", "", UdFloat, UdDouble,
                   InformationFloat, InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {1, 3, 8, 33}) {
        CAPTURE(columns);
        const Problem problem(engine, {300, columns, 3}, Columns::independent, 100, some_forgetting);
        const BatchSolution before = solve_by_qr(part(problem.regression, 0, 150));
        // P = R⁻¹ R⁻ᵀ = U D U' with R⁻¹ = U D^(1/2).
        const MatrixXd root = before.information_root.triangularView<Eigen::Upper>().solve(
            MatrixXd::Identity(columns, columns));
        const VectorXd scale = root.diagonal();
        const Start start{before.weights, root * scale.cwiseInverse().asDiagonal(), scale.cwiseAbs2()};
        LearnerUnderTest<TestType> learned(start, 1e4, problem.regression.forgetting_factor);
        CHECK(information_error(before, learned.weights()) < TestType::tolerance);
        CHECK(largest_relative_error(learned.parameter_variances(), before.parameter_variances()) <
              TestType::tolerance);
        learned.learn(part(problem.regression, 150, 300));
        CHECK(information_error(problem.truth, learned.weights()) < TestType::tolerance);
        CHECK(largest_relative_error(learned.parameter_variances(), problem.truth.parameter_variances()) <
              TestType::tolerance);
    }
}

TEMPLATE_TEST_CASE("reset forgets all that was learned", "", UdFloat, UdDouble, InformationFloat,
                   InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const Problem problem(engine, {50, 9, 2}, Columns::independent, 100, some_forgetting);
    Learned<TestType> learned(problem.regression);
    learned.begin(problem.regression.rows.row(0), problem.regression.targets.row(0));
    learned.learner().reset();
    CHECK(learned.learner().idle());
    CHECK_FALSE(learned.learner().sample_pending());
    CHECK(learned.weights().isZero(0));
    CHECK(largest_relative_error(learned.parameter_variances(), VectorXd::Constant(9, 100)) < 1e-6);
    learned.learn(problem.regression);
    CHECK(learned.weights() == Learned<TestType>(problem.regression).weights());
}

TEMPLATE_TEST_CASE("the ratio of a row is one plus its variance before it was learned", "", UdFloat, UdDouble,
                   InformationFloat, InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const Problem problem(engine, {40, 10, 2}, Columns::independent, 100, some_forgetting);
    Learned<TestType> learned(problem.regression);
    for (const VectorXd row : problem.new_rows.rowwise()) {
        const double variance = learned.variance(row);
        learned.begin(row, VectorXd::Zero(2));
        learned.advance(Budget::unlimited());
        CHECK(static_cast<double>(learned.learner().last_ratio()) == Approx(1 + variance).epsilon(1e-5));
    }
}

TEMPLATE_TEST_CASE("rows of other noise weigh as the batch solution says", "", UdFloat, UdDouble,
                   InformationFloat, InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int columns = 20;
    Regression regression =
        with_prior(random_regression(engine, {300, columns, 3}, Columns::independent), 100, 1);
    LearnerUnderTest<TestType> learner(columns, 3, 100, 1);
    for (int t = 0; t < regression.row_count(); ++t) {
        const double deviation = 1 << (engine() % 8); // exact in float
        learner.learn_noisy(regression.rows.row(t), regression.targets.row(t), deviation * deviation);
        regression.rows.row(t) /= deviation;
        regression.targets.row(t) /= deviation;
    }
    const BatchSolution truth = solve_by_qr(regression);
    CHECK(relative_error(learner.weights(), truth.weights) < TestType::tolerance);
    CHECK(largest_relative_error(learner.parameter_variances(), truth.parameter_variances()) <
          TestType::tolerance);
}

TEMPLATE_TEST_CASE("a covariance taken back to the prior's leaves the weights, and goes on as from a start",
                   "", UdFloat, UdDouble, InformationFloat, InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int columns = 20;
    const Regression regression =
        with_prior(random_regression(engine, {200, columns, 3}, Columns::independent), 100, 1);
    LearnerUnderTest<TestType> learner(columns, 3, 100, 1);
    learner.learn(part(regression, 0, 100));
    const MatrixXd before = learner.weights();
    learner.learner().reset_covariance();
    const Cost cost = TestType::template Learner<dynamic, dynamic>::cost(columns, 3);
    std::int64_t spent = 0;
    for (bool done = false; !done;) {
        Budget budget{cost.largest_step};
        const std::int64_t given = budget.operations;
        done = learner.learner().advance(budget);
        spent += given - budget.operations;
        REQUIRE(spent <= cost.reset_covariance);
    }
    CHECK(spent == cost.reset_covariance);
    CHECK(relative_error(learner.weights(), before) < TestType::tolerance / 10);
    CHECK(largest_relative_error(learner.parameter_variances(), VectorXd::Constant(columns, 100)) <
          TestType::tolerance / 10);

    Start start = Start::prior(columns, 3, 100);
    start.weights = learner.weights();
    LearnerUnderTest<TestType> fresh(start, 100, 1);
    learner.learn(part(regression, 100, 200));
    fresh.learn(part(regression, 100, 200));
    CHECK(relative_error(learner.weights(), fresh.weights()) < TestType::tolerance / 10);
}

} // namespace learner_test
