// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/combined_estimator.hpp"

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

/// A sample of a motion with outputs that depend on it.
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

std::vector<float> predictions(RuntimeEstimator& estimator, int first, int last) {
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

TEST_CASE("a combination of an estimator with itself equals that estimator") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> twice(2, small_model(engine, InputKind::DFR));
    const auto combined = make_estimator(twice, false);
    const auto single = make_estimator(twice.front(), false);
    CHECK(predictions(*combined, 0, 200) == predictions(*single, 0, 200));
    CHECK(combined->cost().learn > 2 * single->cost().learn);
}

/// Independent members, combined by the test itself.
class ByHand {
  public:
    using Combination = dfdyn::ForecastCombination<float, 2, 6>;

    explicit ByHand(const std::vector<TrainedModel>& models, float factor = Combination::variance_factor)
        : members_{make_estimator(models[0], false), make_estimator(models[1], false)},
          combination_({}, {}, static_cast<float>(combination_memory_s / 0.004), noise(models).data(),
                       factor) {
        for (int copy = 0; copy < 2; ++copy) {
            hold();
        }
    }

    /// The combined prediction of a tick. The combination learns its sample if any member did.
    std::array<float, 6> tick(const MotionTick& motion, dfdyn::Budget budget = dfdyn::Budget::unlimited()) {
        std::array<float, 12> predictions{}, ahead{}, deviations{};
        std::array<float, 6> result{}, measured{};
        bool predicted = true;
        const bool learns = budget.operations > 0;
        for (std::size_t j = 0; j < 2; ++j) {
            const auto row = static_cast<std::ptrdiff_t>(6 * j);
            const Tick one = members_[j]->tick(motion.sample(), budget);
            predicted = predicted && one.status.estimated();
            std::ranges::copy(one.prediction, predictions.begin() + row);
            std::ranges::copy(one.standard_deviation, deviations.begin() + row);
            members_[j]->predict_with(held_[j][1], std::span(ahead).subspan(6 * j, 6));
        }
        if (predicted) {
            combination_.weigh(deviations.data());
            combination_.combine(predictions.data(), result.data());
            std::ranges::copy(motion.output, measured.begin());
            learns ? combination_.learn(predictions.data(), ahead.data(), measured.data())
                   : combination_.skip();
        }
        if (++ticks_ % 50 == 0) { // 0.2 s
            hold();
        }
        return result;
    }

    float weight() const { return combination_.weights()[0]; }

  private:
    static std::vector<float> noise(const std::vector<TrainedModel>& models) {
        std::vector<float> all;
        for (const TrainedModel& model : models) {
            all.insert(all.end(), model.outputs.noise_std.begin(), model.outputs.noise_std.end());
        }
        return all;
    }
    void hold() {
        for (std::size_t j = 0; j < 2; ++j) {
            held_[j][1] = held_[j][0];
            held_[j][0].resize(members_[j]->weight_count());
            members_[j]->copy_weights(held_[j][0]);
        }
    }

    std::array<std::unique_ptr<RuntimeEstimator>, 2> members_;
    Combination combination_;
    std::array<std::array<std::vector<float>, 2>, 2> held_; ///< the newer copy, then the older one
    int ticks_ = 0;
};

/// The library and the test may contract multiply-adds differently.
bool same_but_for_rounding(std::span<const float> one, std::span<const float> other) {
    return std::ranges::equal(
        one, other, [](float a, float b) { return std::abs(a - b) <= 1e-5F * std::max(1.0F, std::abs(b)); });
}

TEST_CASE("a combined estimator equals its separate members plus the combination") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> models = two_models(engine);
    const auto combined = make_estimator(models, false);
    ByHand by_hand(models);
    for (int tick = 0; tick < 300; ++tick) {
        const MotionTick motion(tick);
        const std::array<float, 6> expected = by_hand.tick(motion);
        const Tick result = combined->tick(motion.sample());
        REQUIRE(result.status.predicted() == (tick >= 4));
        REQUIRE(same_but_for_rounding(result.prediction, expected));
    }
    CHECK(by_hand.weight() != Approx(0.5)); // it prefers one member
}

TEST_CASE(
    "until errors are known the deviations set the weights and count as calibrated if all members are") {
    DFDYN_SEEDED_ENGINE(engine);
    using Combination = ByHand::Combination;
    std::vector<TrainedModel> models = two_models(engine);
    const bool all = GENERATE(false, true);
    dfdyn::tests::add_extrapolation(models[0], engine);
    if (all) {
        dfdyn::tests::add_extrapolation(models[1], engine);
    }
    const auto combined = make_estimator(models, false);
    const std::array factors{Combination::variance_factor, Combination::calibrated_variance_factor};
    ByHand expected(models, factors[all ? 1 : 0]);
    ByHand other(models, factors[all ? 0 : 1]);
    bool differs = false;
    for (int tick = 0; tick < 100; ++tick) {
        const MotionTick motion(tick);
        const auto budget = dfdyn::Budget::predict_only();
        const Tick result = combined->tick(motion.sample(), budget);
        REQUIRE(same_but_for_rounding(result.prediction, expected.tick(motion, budget)));
        differs = !same_but_for_rounding(result.prediction, other.tick(motion, budget)) || differs;
    }
    CHECK(differs);
}

/// The mean square errors of the combination and of the weights that follow from them.
std::vector<float> numbers_of(const RuntimeEstimator& estimator) {
    std::vector<float> numbers(estimator.weight_count());
    estimator.copy_weights(numbers);
    return numbers;
}

bool same_errors(const std::vector<float>& one, const std::vector<float>& other) {
    return std::equal(one.begin(), one.begin() + 12, other.begin());
}

/// Whether the combination's part of the snapshots differs: a header, a count and three tables of 12 means.
bool combination_learned(const std::vector<std::byte>& before, const std::vector<std::byte>& after) {
    constexpr std::size_t bytes = sizeof(dfdyn::SnapshotHeader) + 37 * sizeof(float);
    return !std::equal(before.begin(), before.begin() + bytes, after.begin());
}

TEST_CASE("a combination learns its weights unless every member rejects the sample") {
    DFDYN_SEEDED_ENGINE(engine);
    const bool all = GENERATE(false, true);
    std::vector<TrainedModel> models = two_models(engine);
    for (TrainedModel& model : models) {
        if (all || &model == &models[1]) {
            model.limits.innovation = 1e-6; // every sample contradicts it
            model.limits.innovation_patience = 1'000'000;
        }
    }
    const auto combined = make_estimator(models, false);
    predictions(*combined, 0, 50);
    const std::vector<std::byte> before_snapshot = combined->snapshot();
    const Tick result = combined->tick(MotionTick(50).sample());
    CHECK(result.status.predicted());
    CHECK(result.status.learning == dfdyn::Reason::innovation_too_large);
    CHECK(combination_learned(before_snapshot, combined->snapshot()) != all);
}

TEST_CASE("a combination learns its weights while its members learn in slices but not without a budget") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto combined = make_estimator(two_models(engine), false);
    predictions(*combined, 0, 50);
    const std::int64_t slice = combined->cost().learn / 20;
    const std::vector<float> before = numbers_of(*combined);
    for (int tick = 50; tick < 60; ++tick) {
        const Tick result = combined->tick(MotionTick(tick).sample(), {slice});
        CHECK_FALSE(result.status.learned());
    }
    combined->advance(dfdyn::Budget::unlimited());
    const std::vector<float> sliced = numbers_of(*combined);
    CHECK_FALSE(same_errors(before, sliced));
    const std::vector<std::byte> learned = combined->snapshot();
    for (int tick = 60; tick < 70; ++tick) {
        combined->tick(MotionTick(tick).sample(), dfdyn::Budget::predict_only());
    }
    CHECK(combined->snapshot() == learned);
}

TEST_CASE("a combination lacking a member's prediction predicts zero with infinite deviation") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto combined = make_estimator(two_models(engine), false);
    predictions(*combined, 0, 50);
    const MotionTick motion(50);
    MeasuredSample sample = motion.sample();
    const std::array wrong{std::nan(""), 0.0};
    sample.position = wrong;
    const Tick result = combined->tick(sample);
    CHECK_FALSE(result.status.predicted());
    CHECK(result.prediction[0] == 0);
    CHECK(std::isinf(result.standard_deviation[0]));
}

TEST_CASE("weights copied before a tick without learning give the prediction of that tick") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<TrainedModel> models = two_models(engine);
    const auto combined = make_estimator(models, false);
    predictions(*combined, 0, 50);
    std::vector<float> weights(combined->weight_count());
    std::array<float, 6> prediction{};
    const auto budget = dfdyn::Budget::predict_only();
    for (int tick = 50; tick < 2100; ++tick) {
        combined->copy_weights(weights);
        const MotionTick motion(tick);
        const Tick result = combined->tick(motion.sample(), budget);
        REQUIRE(result.status.predicted());
        if (tick < 2050) { // within ten memories, each tick changes the influence of the past errors
            continue;
        }
        combined->predict_with(weights, prediction);
        for (std::size_t k = 0; k < 6; ++k) {
            REQUIRE(prediction[k] == Approx(result.prediction[k]).epsilon(1e-4).margin(1e-4));
        }
    }
}

TEST_CASE("a combination continues from its snapshot and rejects any other") {
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
    broken.back() ^= std::byte{1}; // in the last member; the first members are valid
    CHECK_FALSE(combined->restore(broken));
    CHECK_FALSE(combined->restore({}));
    CHECK(combined->snapshot() == before);
}
