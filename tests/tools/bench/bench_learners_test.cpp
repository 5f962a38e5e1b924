// SPDX-License-Identifier: Apache-2.0
// Every timed learner must give the batch solution, so that no fast but wrong learner is shown.
#include "tools/bench/suites/model_bench.hpp"
#include "tools/bench/suites/tick_bench.hpp"

#include "tests/support/catch.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>

using namespace dfdyn::tools;

namespace {

void check_all(const BenchLearners& learners, const RegressionTask& task) {
    constexpr int ticks = 200; // some rows are used twice
    const RegressionTask::Matrix expected = task.batch_predictions(ticks);
    for (const auto& learner : learners) {
        CAPTURE(learner->name(), learner->scalar());
        for (int t = 0; t < ticks; ++t) {
            learner->tick();
        }
        CHECK(relative_error(learner->predictions(), expected) <= tolerated_error(learner->scalar()));
        learner->tick();
        // One more row changes the predictions.
        CHECK(relative_error(learner->predictions(), expected) > 1e-5);
    }
}

} // namespace

TEST_CASE("all learners of the benchmark give the predictions of the batch solution") {
    const RegressionTask task(100);
    const BenchLearners ours = dfdyn_learners(task);
    CHECK(ours.size() == 2);
    check_all(ours, task);
    const BenchLearners others = peers(task);
    CHECK(others.size() ==
          4U + (gurls_peer.make ? 1 : 0) + (qrupdate_peer.make ? 2 : 0) + (dlib_peer.make ? 1 : 0));
    check_all(others, task);
}

// Independent of the code above: the dual form over the distinct rows.
TEST_CASE("the batch solution equals the solution of the dual problem") {
    const RegressionTask task(200);
    const auto& rows = task.rows();
    Eigen::MatrixXd kernel = RegressionTask::prior_variance * rows * rows.transpose();
    const RegressionTask::Matrix expected =
        kernel * (kernel + Eigen::MatrixXd::Identity(rows.rows(), rows.rows())).ldlt().solve(task.targets());
    CHECK(relative_error(task.batch_predictions(RegressionTask::distinct_rows), expected) < 1e-9);
}

TEST_CASE("an error is relative and infinite for values that are not finite") {
    RegressionTask::Matrix expected(1, 2);
    expected << 3, -4;
    RegressionTask::Matrix values(1, 2);
    values << 3, -5;
    CHECK(relative_error(values, expected) == Approx(1 / std::sqrt(12.5)));
    values << 3, std::numeric_limits<double>::quiet_NaN();
    CHECK(relative_error(values, expected) == std::numeric_limits<double>::infinity());
}

TEST_CASE("the fast form and the dense form of SPK are the same regression") {
    MultiplyAddProbe probe;
    const RepetitionOptions few{.passes = 1, .repetition_us = 0, .fewest_ticks = 1};
    const ModelBench bench = run_small_model_bench(few, 40, probe);
    CHECK(bench.kernel_error < 1e-3);
    CHECK(bench.dense.ticks > 0);
    CHECK(bench.kernel.ticks == 1);
}

TEST_CASE("the fastest of a kind is the fastest correct one") {
    const auto result = [](BenchLearner::Kind kind, const std::string& name, double median, bool right) {
        TickResult one{name, "float", kind, 100, 0, right, {}};
        one.times.median = median;
        return one;
    };
    using enum BenchLearner::Kind;
    const TickBench bench{{result(ours, "a", 1, true), result(covariance, "b", 3, true),
                           result(cholesky, "c", 2, false), result(cholesky, "d", 5, true),
                           result(other, "e", 4, true)},
                          {}};
    CHECK(find_ours(bench, "float", 100)->learner == "a");
    CHECK(fastest_peer(bench, "float", 100)->learner == "b");
    CHECK(fastest_of(bench, cholesky, "float", 100)->learner == "d");
    CHECK(fastest_peer(bench, "double", 100) == nullptr);
    CHECK(find_lower_bound(bench, "float", 100) == nullptr);
}
