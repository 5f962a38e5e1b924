// SPDX-License-Identifier: Apache-2.0
#include "tools/host/combined_estimator.hpp"

#include "dfdyn/forecast_combination.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::small_model;
using dfdyn::tests::small_physics_model;

/// A sample of a motion and of outputs that depend on it.
struct MotionTick {
    explicit MotionTick(int tick) : number(tick) {
        const double t = 0.004 * tick;
        position = {std::sin(3 * t), std::cos(5 * t)};
        for (std::size_t k = 0; k < 6; ++k) {
            output[k] = position[0] * static_cast<double>(k) + position[1];
        }
    }
    MeasuredSample sample() const {
        return {std::int64_t{4000000} * number, position, position, position, output};
    }

    int number;
    std::array<double, 2> position{};
    std::array<double, 6> output{};
};

std::vector<float> predictions(HostEstimator& estimator, int first, int last) {
    std::vector<float> all;
    for (int tick = first; tick < last; ++tick) {
        const MotionTick motion(tick);
        const Tick result = estimator.tick(motion.sample());
        all.insert(all.end(), result.prediction.begin(), result.prediction.end());
    }
    return all;
}

std::vector<TrainedModel> two_models(std::mt19937_64& engine) {
    return {small_model(engine, InputKind::DFR), small_physics_model(engine, "SPK", InputKind::DF, true)};
}

} // namespace

TEST_CASE("a combination of an estimator with itself is that estimator") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> twice(2, small_model(engine, InputKind::DFR));
    const auto combined = make_estimator(twice, false);
    const auto single = make_estimator(twice.front(), false);
    CHECK(predictions(*combined, 0, 200) == predictions(*single, 0, 200));
    CHECK(combined->cost().learn > 2 * single->cost().learn);
}

TEST_CASE("a combined estimator is its members side by side, and what combines them") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> models = two_models(engine);
    const auto combined = make_estimator(models, false);
    const auto first = make_estimator(models[0], false);
    const auto second = make_estimator(models[1], false);
    dfdyn::ForecastCombination<float, 2, 6> combination({}, {}, combination_memory);
    int learned = 0;
    for (int tick = 0; tick < 300; ++tick) {
        const MotionTick motion(tick);
        const std::array ticks{first->tick(motion.sample()), second->tick(motion.sample())};
        const Tick result = combined->tick(motion.sample());
        std::array<float, 12> predictions{};
        std::ranges::copy(ticks[0].prediction, predictions.begin());
        std::ranges::copy(ticks[1].prediction, predictions.begin() + 6);
        std::array<float, 6> expected{};
        combination.combine(predictions.data(), expected.data());
        const bool both = ticks[0].status.learned() && ticks[1].status.learned();
        REQUIRE(result.status.learned() == both);
        REQUIRE(std::ranges::equal(result.prediction, expected));
        if (both) {
            ++learned;
            std::array<float, 6> measured{};
            std::ranges::copy(motion.output, measured.begin());
            combination.learn(predictions.data(), measured.data());
        }
    }
    CHECK(learned > 200);
    CHECK(combination.weights()[0] != Approx(0.5)); // it has chosen
}

TEST_CASE("where one member refuses a sample, the combination says so, and its weights stay") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<TrainedModel> models = two_models(engine);
    models[1].limits.innovation = 1e-6; // contradicted by everything
    models[1].limits.innovation_patience = 1'000'000;
    const auto combined = make_estimator(models, false);
    predictions(*combined, 0, 50);
    std::vector<float> before(combined->weight_count());
    combined->copy_weights(before);
    const MotionTick motion(50);
    const Tick result = combined->tick(motion.sample());
    CHECK(result.status.predicted());
    CHECK(result.status.learning == dfdyn::Reason::innovation_too_large);
    std::vector<float> after(before.size());
    combined->copy_weights(after);
    CHECK(std::equal(before.begin(), before.begin() + 12, after.begin()));
    CHECK(before != after); // the other member learned
}

TEST_CASE("a combination's weights, copied before a tick, predict what the tick does") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> models = two_models(engine);
    const auto combined = make_estimator(models, false);
    std::vector<float> weights(combined->weight_count());
    std::array<float, 6> prediction{};
    for (int tick = 0; tick < 100; ++tick) {
        combined->copy_weights(weights);
        const MotionTick motion(tick);
        const Tick result = combined->tick(motion.sample());
        if (result.status.predicted()) {
            combined->predict_with(weights, prediction);
            for (std::size_t k = 0; k < 6; ++k) {
                REQUIRE(prediction[k] == Approx(result.prediction[k]).epsilon(1e-4).margin(1e-4));
            }
        }
    }
}

TEST_CASE("a combination goes on from its snapshot as it did when it was taken, and takes no other") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> models = two_models(engine);
    const auto combined = make_estimator(models, false);
    predictions(*combined, 0, 100);
    const std::vector<std::byte> snapshot = combined->snapshot();
    CHECK(snapshot.size() == combined->state_bytes());
    combined->begin_recording();
    const std::vector<float> expected = predictions(*combined, 200, 300);
    REQUIRE(combined->restore(snapshot));
    CHECK(predictions(*combined, 200, 300) == expected);

    const std::vector<std::byte> before = combined->snapshot();
    std::vector<std::byte> broken = snapshot;
    broken.back() ^= std::byte{1}; // of the last member: the first are sound
    CHECK_FALSE(combined->restore(broken));
    CHECK_FALSE(combined->restore({}));
    CHECK(combined->snapshot() == before);
}
