// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/learned_feed_forward.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace learned_feed_forward_test {

using namespace dfdyn::tools;
using dfdyn::tests::unlearned_model;

constexpr double period_s = 0.008;
constexpr std::int64_t period = 8'000'000;

TrainedModel model_of(std::mt19937_64& engine, const std::vector<std::string>& outputs = {"tau1", "tau2"},
                      int joints = 2) {
    return unlearned_model(engine, joints, period_s, outputs, 30);
}

JointVector position(int tick) {
    JointVector result(2);
    result << 0.4 * std::sin(0.02 * tick), 0.5 * std::cos(0.03 * tick) - 0.5;
    return result;
}
JointVector torque(const JointVector& position) {
    JointVector result(2);
    result << 3 * position[0] + std::sin(3 * position[1]), 2 * position[1] * position[1] - 1;
    return result;
}

/// Learns the measured `torque` of two joints at the motion's `tick`, in `ticks` slices.
void learn_sample(LearnedFeedForward& feed_forward, int tick, const double* torque, int ticks,
                  std::int64_t sample_period = period) {
    feed_forward.learn(tick * sample_period, position(tick).data(), torque);
    for (int slice = 1; slice < ticks; ++slice) {
        feed_forward.go_on();
    }
}

/// Learns `count` samples of the motion, each in `ticks` slices.
void learn(LearnedFeedForward& feed_forward, int first, int count, int ticks) {
    for (int tick = first; tick < first + count; ++tick) {
        learn_sample(feed_forward, tick, torque(position(tick)).data(), ticks);
    }
}

constexpr std::int64_t physics_period = 4'000'000; ///< of `physics_model`

/// A model of features, whose part is no larger than the noise, and of physics.
TrainedModel physics_model(std::mt19937_64& engine) {
    TrainedModel model = dfdyn::tests::small_physics_model(engine, "SPK", InputKind::DFR, /*wrench=*/false);
    model.outputs.prior_variance = 1;
    return model;
}

/// Returns the predictions along the motion.
std::vector<JointVector> follow(LearnedFeedForward& feed_forward, int first, int count) {
    std::vector<JointVector> predictions;
    for (int tick = first; tick < first + count; ++tick) {
        JointVector predicted(2);
        if (feed_forward.predict(tick * period, position(tick).data(), predicted.data())) {
            predictions.push_back(predicted);
        }
    }
    return predictions;
}

std::string refusal(const TrainedModel& model) {
    try {
        const LearnedFeedForward feed_forward(model, true, 2, 8, "m.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST_CASE("a model learned from measured positions predicts the torque at reference positions") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(model_of(engine), true, 2, 8, "model");
    feed_forward.begin(0, position(0).data());
    learn(feed_forward, 1, 1500, 8);
    const std::vector<JointVector> predicted = follow(feed_forward, 1, 300);
    REQUIRE(predicted.size() == 300);
    double square = 0;
    for (int tick = 11; tick < 301; ++tick) {
        square += (predicted[static_cast<std::size_t>(tick - 1)] - torque(position(tick))).squaredNorm();
    }
    CHECK(std::sqrt(square / 290) < 0.1); // the torques are about 1 N·m
    CHECK(feed_forward.counters().samples == 1500);
    CHECK(feed_forward.counters().learned == 1500 - 4); // the window of 5 positions was empty at first
    CHECK(feed_forward.counters().faults == 0);
}

TEST_CASE("learning in the slices of eight ticks equals learning at once bit for bit") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = model_of(engine);
    std::vector<std::vector<JointVector>> predictions;
    for (const int ticks : {1, 8}) {
        LearnedFeedForward feed_forward(model, true, 2, ticks, "model");
        feed_forward.begin(0, position(0).data());
        learn(feed_forward, 1, 200, ticks);
        predictions.push_back(follow(feed_forward, 1, 50));
    }
    CHECK(predictions[0] == predictions[1]);
    CHECK(predictions[0].back() != JointVector::Zero(2));
}

TEST_CASE("more ticks per sample reduce the cost of each tick") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = model_of(engine);
    const std::int64_t one = LearnedFeedForward(model, true, 2, 1, "model").tick_cost();
    const std::int64_t eight = LearnedFeedForward(model, true, 2, 8, "model").tick_cost();
    CHECK(eight < one / 2);
}

TEST_CASE("a model predicts an arm at rest from the start and counts a rejected sample without learning it") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(model_of(engine), true, 2, 8, "model");
    feed_forward.begin(0, position(0).data());
    CHECK(follow(feed_forward, 1, 1).size() == 1);
    learn(feed_forward, 1, 100, 8);
    const std::uint64_t learned = feed_forward.counters().learned;
    JointVector absurd = position(101);
    absurd[1] = 1e9;
    const JointVector measured = torque(position(101));
    feed_forward.learn(101 * period, absurd.data(), measured.data());
    CHECK(feed_forward.counters().learned == learned);
    CHECK(feed_forward.counters().faults == 1);
    CHECK(feed_forward.counters().last_fault == dfdyn::Reason::position_out_of_range);
}

TEST_CASE("a sample without torque is not learned but its position enters the window") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(model_of(engine), true, 2, 8, "model");
    feed_forward.begin(0, position(0).data());
    learn(feed_forward, 1, 100, 8);
    const std::uint64_t learned = feed_forward.counters().learned;
    for (int tick = 101; tick < 201; ++tick) {
        const JointVector measured = torque(position(tick));
        feed_forward.learn(tick * period, position(tick).data(), tick % 2 == 0 ? measured.data() : nullptr);
        for (int slice = 1; slice < 8; ++slice) {
            feed_forward.go_on();
        }
    }
    CHECK(feed_forward.counters().learned == learned + 50);
    CHECK(feed_forward.counters().samples == 150);
}

TEST_CASE("samples that may not be learned change nothing that was learned and enter the window") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(model_of(engine), true, 2, 8, "model");
    feed_forward.begin(0, position(0).data());
    learn(feed_forward, 1, 100, 8);
    const std::vector<std::byte> before = feed_forward.snapshot();
    feed_forward.may_learn(false);
    learn(feed_forward, 101, 3, 8);
    CHECK(feed_forward.snapshot() == before);
    CHECK(feed_forward.counters().samples == 100);
    feed_forward.may_learn(true);
    const std::uint64_t learned = feed_forward.counters().learned;
    learn(feed_forward, 104, 1, 8);
    CHECK(feed_forward.counters().learned == learned + 1);
}

TEST_CASE("the forecast of the physics alone follows a change of the arm before the whole model's") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(physics_model(engine), true, 2, 4, "model");
    REQUIRE(feed_forward.forecast_count() == 3);
    CHECK(LearnedFeedForward(model_of(engine), true, 2, 4, "model").forecast_count() == 1);
    constexpr double load = 5;
    std::array<double, 6> predicted{}; // the whole model, then the physics with a short and a long memory
    feed_forward.begin(0, position(0).data());
    for (int tick = 1; tick <= 2250; ++tick) { // at 2000 the load of joint 2 changes its sign
        const std::array<double, 2> measured{0, tick <= 2000 ? load : -load};
        learn_sample(feed_forward, tick, measured.data(), 4, physics_period);
        REQUIRE(feed_forward.predict(tick * physics_period, position(tick).data(), predicted.data()));
    }
    CHECK(predicted[3] < -0.3 * load);
    CHECK(predicted[1] > predicted[3] + 0.5 * load);
    CHECK(predicted[5] > predicted[3] + 0.5 * load);
}

TEST_CASE("of an unchanged arm's noisy torque a long memory of the physics is better than a short one") {
    DFDYN_SEEDED_ENGINE(engine);
    LearnedFeedForward feed_forward(physics_model(engine), true, 2, 4, "model");
    constexpr double load = 5;
    std::normal_distribution<double> noise(0, 1);
    std::array<double, 6> predicted{};
    double short_memory = 0; // sums of square errors
    double long_memory = 0;
    feed_forward.begin(0, position(0).data());
    for (int tick = 1; tick <= 6000; ++tick) {
        const std::array<double, 2> measured{noise(engine), load + noise(engine)};
        learn_sample(feed_forward, tick, measured.data(), 4, physics_period);
        REQUIRE(feed_forward.predict(tick * physics_period, position(tick).data(), predicted.data()));
        short_memory += tick > 3000 ? std::pow(predicted[3] - load, 2) : 0;
        long_memory += tick > 3000 ? std::pow(predicted[5] - load, 2) : 0;
    }
    CAPTURE(short_memory, long_memory);
    CHECK(long_memory < 0.5 * short_memory);
}

TEST_CASE("forecasts of a reference out of range and those beyond the model's bounds are NaN") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = physics_model(engine);
    model.limits.prediction = {0, 2}; // N·m; joint 1 has no bound
    LearnedFeedForward learned(model, true, 2, 4, "model");
    learned.begin(0, position(0).data());
    for (int tick = 1; tick <= 2000; ++tick) {
        const std::array<double, 2> measured{0, 5};
        learn_sample(learned, tick, measured.data(), 4, physics_period);
    }
    LearnedFeedForward restored(model, true, 2, 4, "model"); // its physics alone have learned nothing
    REQUIRE(restored.restore(learned.snapshot()));
    restored.begin(0, position(0).data());
    std::array<double, 6> predicted{};
    REQUIRE(restored.predict(physics_period, position(1).data(), predicted.data()));
    CHECK((std::isnan(predicted[0]) && std::isnan(predicted[1])));
    CHECK(std::all_of(predicted.begin() + 2, predicted.end(),
                      [](double value) { return std::isfinite(value); }));
    CHECK(restored.counters().reference_unknown == 0);
    const std::array<double, 2> absurd{1e9, 0};
    CHECK_FALSE(restored.predict(2 * physics_period, absurd.data(), predicted.data()));
    CHECK(std::ranges::all_of(predicted, [](double value) { return std::isnan(value); }));
    CHECK(restored.counters().reference_unknown == 1);
}

TEST_CASE("where the arguments of the features are out of range the physics alone is predicted") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = physics_model(engine);
    for (double& scale : model.input.scale) {
        scale *= 1e9;
    }
    LearnedFeedForward feed_forward(model, true, 2, 4, "model");
    constexpr double load = 5;
    std::array<double, 6> predicted{};
    feed_forward.begin(0, position(0).data());
    for (int tick = 1; tick <= 2000; ++tick) {
        const std::array<double, 2> measured{0, load};
        learn_sample(feed_forward, tick, measured.data(), 4, physics_period);
        REQUIRE(feed_forward.predict(tick * physics_period, position(tick).data(), predicted.data()));
    }
    CHECK((std::isnan(predicted[0]) && std::isnan(predicted[1])));
    CHECK(predicted[3] == Approx(load).epsilon(0.2));
    CHECK(predicted[5] == Approx(load).epsilon(0.2));
    CHECK(feed_forward.counters().last_fault == dfdyn::Reason::input_out_of_range);
    CHECK(feed_forward.counters().reference_unknown == 0);
}

TEST_CASE("a model that does not map these joints' positions to their torques is rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    CHECK(refusal(model_of(engine)) == "none");
    CHECK(refusal(model_of(engine, {"i1", "i2"})) ==
          "m.json: expected a model of the outputs tau1, tau2, found one of i1, i2");
    CHECK(refusal(model_of(engine, {"tau1", "tau2", "tau3"}, 3)) ==
          "m.json: expected a model of the outputs tau1, tau2, found one of tau1, tau2, tau3");
    TrainedModel measured = model_of(engine);
    measured.input.kind = InputKind::STD;
    measured.input.derivatives = Derivatives::measured;
    CHECK(refusal(measured) == "m.json: expected a model of positions alone, found one that needs measured "
                               "derivatives (input STD)");
}

TEST_CASE("a model continues from its snapshot and rejects a damaged one") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = model_of(engine);
    LearnedFeedForward feed_forward(model, true, 2, 8, "model");
    LearnedFeedForward other(model, true, 2, 8, "model");
    feed_forward.begin(0, position(0).data());
    other.begin(0, position(0).data());
    learn(feed_forward, 1, 500, 8);
    std::vector<std::byte> snapshot = feed_forward.snapshot();
    REQUIRE(other.restore(snapshot));
    other.begin(0, position(0).data());
    CHECK(follow(other, 1, 50) == follow(feed_forward, 1, 50));
    snapshot[snapshot.size() / 2] ^= std::byte{1};
    CHECK_FALSE(other.restore(snapshot));
}

} // namespace learned_feed_forward_test
