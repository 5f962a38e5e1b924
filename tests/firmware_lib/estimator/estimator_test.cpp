// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/regression.hpp"
#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace estimator_test {

using namespace dfdyn;
using namespace dfdyn::tests;

template <class Scalar>
using ModelOf = TestModel<Scalar>;
using DoubleModel = ModelOf<double>;
constexpr int lags = 6;

/// The estimator's columns and inputs, tick by tick, in the learner's units.
struct Record {
    Regression regression;
    int count = 0;

    explicit Record(int capacity) {
        regression.rows.resize(capacity, DoubleModel::columns);
        regression.targets.resize(capacity, DoubleModel::outputs);
    }

    void add(const Estimator<DoubleModel>& estimator, const DoubleModel::Constants& constants,
             const DoubleModel::Sample& sample) {
        for (int j = 0; j < DoubleModel::columns; ++j) {
            regression.rows(count, j) = estimator.regression().columns()[j];
        }
        for (int k = 0; k < DoubleModel::outputs; ++k) {
            regression.targets(count, k) =
                (sample.output[k] - constants.output_offset[k]) / constants.output_noise_std[k];
        }
        ++count;
    }

    [[nodiscard]] BatchSolution solution(double prior_variance) const {
        return solve_by_qr(with_prior(part(regression, 0, count), prior_variance, 1));
    }
};

TEMPLATE_TEST_CASE("nothing is predicted until the window is full and the reason is window_filling", "",
                   float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = ModelOf<TestType>;
    const auto constants = make_constants<Model>(engine);
    Estimator<Model> estimator(constants);
    for (int t = 0; t < lags; ++t) {
        const auto estimate = estimator.tick(moving_sample<Model>(t, engine), Budget::unlimited());
        CHECK(estimate.status.prediction == Reason::window_filling);
        CHECK_FALSE(estimate.status.learned());
        for (int k = 0; k < 2; ++k) {
            CHECK(estimate.prediction[k] == 0);
            CHECK(estimate.standard_deviation[k] == std::numeric_limits<TestType>::infinity());
            CHECK(estimate.innovation[k] == 0);
        }
        CHECK(estimate.normalised_innovation_squared == 0);
    }
    const auto first = estimator.tick(moving_sample<Model>(lags, engine), Budget::unlimited());
    CHECK(first.status.predicted());
    CHECK(first.status.learned());
    CHECK(first.prediction[0] == constants.output_offset[0]); // nothing learned yet
    CHECK(static_cast<double>(first.standard_deviation[1]) == Approx(0.08 * std::sqrt(1001)));
}

TEST_CASE("every estimate equals the batch solution of all samples before it") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<DoubleModel>(engine);
    Estimator<DoubleModel> estimator(constants);
    Record record(200);
    for (int t = 0; t < 200; ++t) {
        const auto sample = moving_sample<DoubleModel>(t, engine);
        const auto estimate = estimator.tick(sample, Budget::unlimited());
        if (!estimate.status.predicted()) {
            continue;
        }
        record.add(estimator, constants, sample);
        if (record.count == 1 || t % 10 != 0) {
            continue;
        }
        Record before = record;
        --before.count;
        const BatchSolution truth = before.solution(constants.learner.prior_variance);
        const Eigen::VectorXd row = record.regression.rows.row(before.count);
        double squares = 0;
        for (int k = 0; k < 2; ++k) {
            const double mean =
                constants.output_offset[k] + constants.output_noise_std[k] * row.dot(truth.weights.col(k));
            const double deviation = constants.output_noise_std[k] * std::sqrt(1 + truth.variance(row));
            REQUIRE(estimate.prediction[k] == Approx(mean).epsilon(1e-9));
            REQUIRE(estimate.standard_deviation[k] == Approx(deviation).epsilon(1e-9));
            REQUIRE(estimate.innovation[k] == sample.output[k] - estimate.prediction[k]);
            squares += std::pow(estimate.innovation[k] / deviation, 2);
        }
        REQUIRE(estimate.normalised_innovation_squared == Approx(squares).epsilon(1e-8));
    }
    CHECK(information_error(record.solution(1000), [&] {
              Eigen::MatrixXd weights(DoubleModel::columns, 2);
              for (int k = 0; k < 2; ++k) {
                  weights.col(k) = Eigen::Map<const Eigen::VectorXd>(
                      estimator.regression().learner().weights(k), DoubleModel::columns);
              }
              return weights;
          }()) < 1e-9);
}

// With data drawn from the model itself the normalised innovations are independent and N(0, 1). The sum of
// their squares is chi-square with m degrees of freedom per tick, with mean m and variance 2m.
TEMPLATE_TEST_CASE("normalised innovations squared have a chi-square distribution on data from the model", "",
                   float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = ModelOf<TestType>;
    const auto constants = make_constants<Model>(engine);
    Estimator<Model> probe(constants); // computes the columns before the sample exists
    Estimator<Model> estimator(constants);
    std::normal_distribution<double> normal;
    Eigen::MatrixXd weights(Model::columns, 2);
    weights = weights.unaryExpr([&](double) { return std::sqrt(1000) * normal(engine); });
    constexpr int count = 20'000;
    double sum = 0;
    std::array<int, 2> within{};
    int predicted = 0;
    for (int t = 0; predicted < count; ++t) {
        auto sample = moving_sample<Model>(t, engine);
        probe.tick(sample, Budget::predict_only());
        for (int k = 0; k < 2; ++k) {
            double value = normal(engine);
            for (int j = 0; j < Model::columns; ++j) {
                value += static_cast<double>(probe.regression().columns()[j]) * weights(j, k);
            }
            sample.output[k] =
                constants.output_offset[k] + constants.output_noise_std[k] * static_cast<TestType>(value);
        }
        const auto estimate = estimator.tick(sample, Budget::unlimited());
        if (!estimate.status.predicted()) {
            continue;
        }
        ++predicted;
        sum += static_cast<double>(estimate.normalised_innovation_squared);
        for (int k = 0; k < 2; ++k) {
            const auto normalised = estimate.innovation[k] / estimate.standard_deviation[k];
            within[static_cast<std::size_t>(k)] +=
                std::abs(static_cast<double>(normalised)) < 1.959964 ? 1 : 0;
        }
    }
    // Five standard deviations of a mean of `count` ticks.
    CHECK(sum / count == Approx(2).margin(5 * std::sqrt(2 * 2.0 / count)));
    for (const int inside : within) {
        CHECK(inside == Approx(0.95 * count).margin(5 * std::sqrt(0.95 * 0.05 * count)));
    }
}

TEST_CASE("the arm's torque is learned to within its noise") {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = TestModel<float, DerivativeFreeStructured<10>, 100>;
    const auto constants = make_constants<Model>(engine);
    Estimator<Model> estimator(constants);
    double squares = 0;
    for (int t = 0; t < 10'000; ++t) {
        const auto sample = moving_sample<Model>(t, engine);
        const auto estimate = estimator.tick(sample, Budget::unlimited());
        squares += t < 9000 ? 0 : std::pow(static_cast<double>(estimate.innovation[0]), 2);
    }
    CHECK(std::sqrt(squares / 1000) < 1.2 * torque_noise);
}

TEST_CASE("a changing arm is followed with forgetting and not without") {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = TestModel<float, DerivativeFreeStructured<10>, 20>;
    const auto error_after_change = [&](double forgetting_factor) {
        const auto constants = make_constants<Model>(engine, forgetting_factor);
        Estimator<Model> estimator(constants);
        double squares = 0;
        for (int t = 0; t < 15'000; ++t) {
            auto sample = moving_sample<Model>(t, engine);
            sample.output[0] += t < 10'000 ? 0.0F : sample.position[0];
            const auto estimate = estimator.tick(sample, Budget::unlimited());
            squares += t < 14'000 ? 0 : std::pow(static_cast<double>(estimate.innovation[0]), 2);
        }
        return std::sqrt(squares / 1000);
    };
    CHECK(error_after_change(0.999) < 1.5 * torque_noise);
    CHECK(error_after_change(1) > 4 * torque_noise);
}

TEST_CASE("a sample without output is predicted and not learned") {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = ModelOf<float>;
    const auto constants = make_constants<Model>(engine);
    Estimator<Model> estimator(constants);
    for (int t = 0; t < 50; ++t) {
        estimator.tick(moving_sample<Model>(t, engine), Budget::unlimited());
    }
    const auto before = snapshot_of(estimator);
    auto sample = moving_sample<Model>(50, engine);
    Estimator<Model> twin = estimator;
    sample.output_valid = false;
    const auto blind = estimator.tick(sample, Budget::unlimited());
    CHECK(blind.status.prediction == Reason::ok);
    CHECK(blind.status.learning == Reason::output_missing);
    CHECK(blind.innovation[0] == 0);
    CHECK(blind.normalised_innovation_squared == 0);
    CHECK((snapshot_of(estimator) == before));
    sample.output_valid = true;
    const auto seeing = twin.tick(sample, Budget::unlimited());
    CHECK(same(seeing.prediction, blind.prediction));
    CHECK(static_cast<double>(seeing.standard_deviation[0]) ==
          Approx(static_cast<double>(blind.standard_deviation[0])).epsilon(1e-5));
}

TEMPLATE_TEST_CASE("reset returns to the initial state, restart_window keeps the learned state", "", float,
                   double) {
    DFDYN_SEEDED_ENGINE(engine);
    using Model = ModelOf<TestType>;
    const auto constants = make_constants<Model>(engine, 0.999);
    Estimator<Model> fresh(constants);
    Estimator<Model> used(constants);
    for (int t = 0; t < 100; ++t) {
        used.tick(moving_sample<Model>(1000 + t, engine), Budget{t % 10 == 0 ? 500 : 5000});
    }
    const auto learned = snapshot_of(used);
    used.restart_window();
    CHECK((snapshot_of(used) == learned));
    // An earlier time: the clock restarts too.
    CHECK(used.tick(moving_sample<Model>(0, engine), Budget::predict_only()).status.prediction ==
          Reason::window_filling);
    used.reset();
    CHECK((snapshot_of(used) == snapshot_of(fresh)));
    CHECK(used.counters().ticks == 0);
    CHECK(used.counters().learned == 0);
    for (int t = 0; t < 100; ++t) {
        const auto sample = moving_sample<Model>(t, engine);
        REQUIRE(same(used.tick(sample, Budget::unlimited()), fresh.tick(sample, Budget::unlimited())));
    }
    CHECK((snapshot_of(used) == snapshot_of(fresh)));
}

TEST_CASE("counters do not overflow within a million years at 10 kHz") {
    constexpr std::uint64_t ticks = std::uint64_t{10'000} * 3600 * 24 * 365 * 1'000'000;
    using Number = decltype(Counters::ticks);
    STATIC_REQUIRE(std::numeric_limits<Number>::max() > ticks);
    STATIC_REQUIRE(std::is_same_v<Number, decltype(Counters::predicted)>);
    STATIC_REQUIRE(std::is_same_v<Number, decltype(Counters::learned)>);
    STATIC_REQUIRE(std::is_same_v<Number&, decltype(std::declval<Counters&>().reasons[0])>);
}

} // namespace estimator_test
