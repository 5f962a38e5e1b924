// SPDX-License-Identifier: Apache-2.0
// The recursive solution equals the batch solution for every form of learner.
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

/// A regression, rows that are not part of it, and its solution.
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
/// so that the bound on the variances, which has its own test, never applies.
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

/// Checks the weights in the norm of the information, and the predictions for the learned rows.
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
    with(UdFloat{});
}

/// Checks each weight: double has enough digits even if columns are nearly equal.
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

TEST_CASE("weights and variances equal the batch solution, for every size and kind of columns") {
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

TEST_CASE("weights and variances equal the batch solution, for hundreds of columns") {
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

// If columns have similar sizes and are not collinear, each weight is determined, and the normal equations
// are accurate enough to be a second reference.
TEST_CASE("each weight equals the solution of the normal equations for well-conditioned columns") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {1, 4, 10, 33, 100}) {
        const Problem problem(engine, {200, columns, 2}, Columns::independent, 100, some_forgetting);
        const NormalEquationsSolution truth = solve_by_ldlt(problem.regression);
        CAPTURE(columns);
        CHECK(relative_error(problem.truth.weights, truth.weights) < 1e-12);
        CHECK(relative_error(Learned<UdDouble>(problem.regression).weights(), truth.weights) < 1e-9);
        CHECK(relative_error(Learned<UdFloat>(problem.regression).weights(), truth.weights) < 1e-3);
    }
}

TEST_CASE("with a weak prior the error in float is below a thousandth over 1,000 rows of features") {
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

// Only the prior distinguishes copies of a column, with weight 1e-6 against 1e3 of the data. That takes nine
// digits, more than a float has. The weights in the norm of the information, and the predictions, are still
// accurate.
TEST_CASE("copies of a column under a weak prior affect neither predictions nor determined weights") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {2, 3, 16, 33, 100}) {
        for (const double lambda : {no_forgetting, some_forgetting}) {
            CAPTURE(columns, lambda);
            const Problem problem(engine, {1000, columns, 2}, Columns::collinear, 1e6, lambda);
            with_each_learner(problem,
                              [](const Problem& same, const auto& learned) { check_weights(same, learned); });
            check_variances(problem, Learned<UdDouble>(problem.regression));
        }
    }
}

TEST_CASE("fixed sizes give the same result as run-time sizes") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto check = [&]<int p, int m>(Extent<p>, Extent<m>) {
        CAPTURE(p, m);
        const Problem problem(engine, {100, p, m}, Columns::independent, 100, some_forgetting);
        CHECK(information_error(problem.truth, Learned<UdDouble, p, m>(problem.regression).weights()) < 1e-9);
        CHECK(information_error(problem.truth, Learned<UdFloat, p, m>(problem.regression).weights()) < 1e-3);
    };
    check(Extent<1>{}, Extent<1>{});
    check(Extent<4>{}, Extent<3>{});
    check(Extent<13>{}, Extent<6>{});
}

TEMPLATE_TEST_CASE("an initial state equals having learned its rows", "", UdFloat, UdDouble) {
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

TEMPLATE_TEST_CASE("reset returns to the initial state", "", UdFloat, UdDouble) {
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

TEMPLATE_TEST_CASE("the ratio of a row is one plus its variance before learning", "", UdFloat, UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const Problem problem(engine, {40, 10, 2}, Columns::independent, 100, some_forgetting);
    Learned<TestType> learned(problem.regression);
    for (const VectorXd row : problem.new_rows.rowwise()) {
        const double variance = learned.variance(row);
        learned.begin(row, VectorXd::Zero(2));
        learned.advance(Budget::unlimited());
        CHECK(static_cast<double>(learned.learner().last_variance_ratio()) ==
              Approx(1 + variance).epsilon(1e-5));
    }
}

TEMPLATE_TEST_CASE("rows with another noise variance are weighted as in the batch solution", "", UdFloat,
                   UdDouble) {
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

TEMPLATE_TEST_CASE("a target that changes at rest is followed within the memory, however long the rest", "",
                   UdFloat, UdDouble) {
    constexpr double forgetting_factor = 0.999;
    const Eigen::VectorXd row = Eigen::VectorXd::Constant(4, 0.5);
    LearnerUnderTest<TestType> learner(4, 1, 100, forgetting_factor);
    const auto rest = [&](double target, int samples) {
        for (int t = 0; t < samples; ++t) {
            learner.begin(row, Eigen::VectorXd::Constant(1, target));
            learner.advance(Budget::unlimited());
        }
    };
    rest(0, 200'000);
    rest(1, static_cast<int>(5 / (1 - forgetting_factor)));
    CHECK(learner.means(row)[0] == Approx(1).margin(0.02));
}

TEMPLATE_TEST_CASE("a covariance reset keeps the weights and continues as from that initial state", "",
                   UdFloat, UdDouble) {
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
