// SPDX-License-Identifier: Apache-2.0
// Forgetting from the prior's covariance: a variance that exceeds the prior's is bounded exactly as
// documented.
#include "dfdyn/learner/forgetting.hpp"

#include "tests/firmware_lib/support/learner_under_test.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/Cholesky>

namespace bounded_variance_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The same algorithm, dense and slow: information matrix and right-hand sides, solved for every row.
class DenseBoundedForgetting {
  public:
    DenseBoundedForgetting(int columns, int outputs, double prior_variance)
        : prior_variance_(prior_variance),
          information_(MatrixXd::Identity(columns, columns) / prior_variance),
          right_hand_sides_(MatrixXd::Zero(columns, outputs)) {}

    void learn(const VectorXd& row, const VectorXd& target, double forgetting_factor) {
        information_ = forgetting_factor * (information_ + row * row.transpose());
        right_hand_sides_ = forgetting_factor * (right_hand_sides_ + row * target.transpose());
        bound(next_);
        next_ = (next_ + 1) % static_cast<int>(row.size());
    }

    [[nodiscard]] BatchSolution solution() const {
        const Eigen::LLT<MatrixXd> factor(information_);
        return {factor.solve(right_hand_sides_), factor.matrixU()};
    }

    [[nodiscard]] int bounded() const { return bounded_; }

  private:
    /// A measurement of parameter i alone, with its present value, that reduces its variance to the prior's.
    void bound(int i) {
        const BatchSolution present = solution();
        const double variance = present.parameter_variances()[i];
        if (variance > prior_variance_) {
            const double precision = 1 / prior_variance_ - 1 / variance;
            information_(i, i) += precision;
            right_hand_sides_.row(i) += precision * present.weights.row(i);
            ++bounded_;
        }
    }

    double prior_variance_;
    MatrixXd information_;
    MatrixXd right_hand_sides_;
    int next_ = 0;
    int bounded_ = 0;
};

/// Rows in which half of the columns are zero, a different half in each half of the time.
Regression partly_excited(std::mt19937_64& engine, RegressionSize size) {
    Regression regression =
        with_prior(random_regression(engine, size, Columns::independent), 100, static_cast<double>(0.99F));
    for (int t = 0; t < size.rows; ++t) {
        for (int j = 0; j < size.columns; ++j) {
            const bool silent = (2 * j < size.columns) == (2 * t < size.rows);
            regression.rows(t, j) *= silent ? 0 : 1;
        }
    }
    return regression;
}

TEMPLATE_TEST_CASE("variances that exceed the prior's are bounded as documented", "", UdFloat, UdDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const int columns : {2, 5, 8, 13}) {
        CAPTURE(columns);
        // 90 rows with 0.99 are less than one horizon, so forgetting is not yet limited by the excitation.
        const Regression regression = partly_excited(engine, {90, columns, 2});
        DenseBoundedForgetting dense(columns, 2, regression.prior_variance);
        LearnerUnderTest<TestType> learned(columns, 2, regression.prior_variance,
                                           regression.forgetting_factor);
        for (int t = 0; t < regression.row_count(); ++t) {
            dense.learn(regression.rows.row(t), regression.targets.row(t), regression.forgetting_factor);
            learned.learn(part(regression, t, t + 1));
        }
        CHECK(dense.bounded() > 20);
        const BatchSolution truth = dense.solution();
        CHECK(information_error(truth, learned.weights()) < TestType::tolerance);
        CHECK(largest_relative_error(learned.parameter_variances(), truth.parameter_variances()) <
              TestType::tolerance);
    }
}

} // namespace bounded_variance_test
