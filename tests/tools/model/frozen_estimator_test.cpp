// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/frozen_estimator.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace frozen_estimator_test {

using namespace dfdyn::tools;
using dfdyn::tests::small_model;
using dfdyn::tests::small_physics_model;
using Outputs = std::array<double, 6>;

struct Replayed {
    std::vector<float> predictions; ///< with standard deviations, tick by tick
    std::vector<float> innovations; ///< normalised, squared
    int learned = 0;
};

/// Ticks over a smooth motion with a gap, and the given outputs.
Replayed run(RuntimeEstimator& estimator, const std::vector<Outputs>& outputs) {
    Replayed replayed;
    for (std::size_t row = 0; row < outputs.size(); ++row) {
        const std::size_t number = row < outputs.size() / 2 ? row : row + 10;
        const double t = 0.004 * static_cast<double>(number);
        const std::array position{std::sin(3 * t), std::cos(5 * t)};
        const MeasuredSample sample{4000000 * static_cast<std::int64_t>(number), position, position, position,
                                    outputs[row]};
        const Tick tick = estimator.tick(sample);
        estimator.advance(dfdyn::Budget::unlimited());
        replayed.predictions.insert(replayed.predictions.end(), tick.prediction.begin(),
                                    tick.prediction.end());
        replayed.predictions.insert(replayed.predictions.end(), tick.standard_deviation.begin(),
                                    tick.standard_deviation.end());
        replayed.innovations.push_back(tick.normalised_innovation_squared);
        replayed.learned += tick.status.learned() ? 1 : 0;
    }
    return replayed;
}

std::vector<Outputs> random_outputs(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    std::vector<Outputs> outputs(300);
    for (Outputs& row : outputs) {
        for (double& value : row) {
            value = normal(engine);
        }
    }
    return outputs;
}

/// Replaces every other value, on average, by one that no sensor should give.
std::vector<Outputs> corrupted(std::vector<Outputs> outputs, std::mt19937_64& engine) {
    constexpr std::array absurd{std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity(), -1e30, 50.0};
    for (Outputs& row : outputs) {
        for (double& value : row) {
            value = engine() % 2 == 0 ? value : absurd[engine() % absurd.size()];
        }
    }
    return outputs;
}

std::vector<std::vector<TrainedModel>> models_of_each_kind(std::mt19937_64& engine) {
    const TrainedModel features = small_model(engine, InputKind::DFR);
    const TrainedModel both = small_physics_model(engine, "SPK", InputKind::DF, true);
    TrainedModel narrow = features;
    narrow.limits.innovation = 2; // many samples contradict it
    narrow.limits.innovation_patience = 3;
    return {{features}, {both}, {narrow}, {features, both}};
}

TEST_CASE("the predictions of a frozen estimator do not depend on the measured outputs bit for bit") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::vector<TrainedModel>& models : models_of_each_kind(engine)) {
        const std::vector<Outputs> outputs = random_outputs(engine);
        const std::vector<Outputs> reversed(outputs.rbegin(), outputs.rend());
        const std::vector<Outputs> absurd = corrupted(outputs, engine);
        const auto estimator = frozen(make_estimator(models, false));
        const std::vector<std::byte> before = estimator->snapshot();
        const Replayed replayed = run(*estimator, outputs);
        CHECK(replayed.learned == 0);
        CHECK(estimator->snapshot() == before);
        for (const std::vector<Outputs>& other : {reversed, absurd}) {
            const auto again = frozen(make_estimator(models, false));
            CHECK(run(*again, other).predictions == replayed.predictions);
        }
    }
}

TEST_CASE("a frozen estimator reports innovations although it does not learn") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_model(engine, InputKind::DFR);
    const auto estimator = frozen(make_estimator(model, false));
    const Replayed replayed = run(*estimator, random_outputs(engine));
    CHECK(replayed.innovations.back() > 0);
    CHECK(estimator->cost().learn == 0);
    CHECK(estimator->cost().predict == make_estimator(model, false)->cost().predict);
}

} // namespace frozen_estimator_test
