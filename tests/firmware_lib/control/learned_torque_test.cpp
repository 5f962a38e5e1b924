// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/control/learned_torque.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace learned_torque_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using Features = TestModel<float>;
using Physical = TestParametric<float>;
using Mean = TestMean<float>;
using Kernel = TestKernel<float>;
using KernelDouble = TestKernel<double>;

template <class Model>
bool close(const typename Model::Scalar* a, const Storage<typename Model::Scalar, 2>& b) {
    const double tolerance = sizeof(typename Model::Scalar) == 4 ? 2e-3 : 1e-9;
    return std::abs(static_cast<double>(a[0] - b[0])) < tolerance &&
           std::abs(static_cast<double>(a[1] - b[1])) < tolerance;
}

/// Returns a learner that has learned from the moving arm.
template <class Model>
std::unique_ptr<LearnedTorque<Model>> learner_of(const typename Model::Constants& constants,
                                                 std::mt19937_64& engine, int samples = 400) {
    auto learner = std::make_unique<LearnedTorque<Model>>(constants, 1);
    for (int t = 0; t < samples; ++t) {
        const auto sample = moving_sample<Model>(t, engine);
        learner->learn(sample.time_ns, sample.position.data(), sample.output.data());
    }
    return learner;
}

// The reference is the estimator's own prediction for the measured window.
TEMPLATE_TEST_CASE("the prediction for the measured motion equals the estimator's prediction", "", Features,
                   Physical, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    Estimator<TestType> estimator(constants);
    LearnedTorque<TestType> learned(constants, 1);
    int compared = 0;
    int different = 0;
    for (int t = 0; t < 500; ++t) {
        const auto sample = moving_sample<TestType>(t, engine);
        typename TestType::Scalar torque[2];
        const bool known = learned.predict(sample.time_ns, sample.position.data(), torque);
        learned.learn(sample.time_ns, sample.position.data(), sample.output.data());
        const auto estimate = estimator.tick(sample, Budget::unlimited());
        REQUIRE(known == estimate.status.predicted());
        compared += known ? 1 : 0;
        different += known && !close<TestType>(torque, estimate.prediction) ? 1 : 0;
    }
    CHECK(compared > 480);
    CHECK(different == 0);
}

TEMPLATE_TEST_CASE("the measured position does not change the prediction for the reference", "", Features,
                   Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<TestType>(engine);
    const auto one = learner_of<TestType>(constants, engine);
    auto other = std::make_unique<LearnedTorque<TestType>>(*one);
    constexpr float start[] = {0.1F, -0.2F};
    one->begin(0, start);
    other->begin(0, start);
    for (int t = 1; t < 50; ++t) {
        const auto sample = moving_sample<TestType>(t, engine); // not learned, because the torque is unknown
        other->learn(sample.time_ns, sample.position.data(), nullptr);
        const float reference[] = {0.1F + 0.01F * static_cast<float>(t), -0.2F};
        float of_one[2];
        float of_other[2];
        REQUIRE(one->predict(t * period_ns, reference, of_one));
        REQUIRE(other->predict(t * period_ns, reference, of_other));
        REQUIRE(of_one[0] == of_other[0]);
        REQUIRE(of_one[1] == of_other[1]);
    }
}

TEST_CASE(
    "an input that differentiates positions predicts from the first call after the beginning of a motion") {
    using Timed = TestModel<float, Standard<6>>;
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Timed>(engine);
    LearnedTorque<Timed> learned(constants, 1);
    constexpr float rest[] = {0.3F, 0.4F};
    float torque[2];
    learned.begin(0, rest);
    CHECK(learned.predict(0, rest, torque));
    learned.begin(0, rest);
    CHECK(learned.predict(period_ns, rest, torque));
}

TEST_CASE("a sample learned in slices changes the prediction when it is complete") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Kernel>(engine);
    constexpr int ticks = 8;
    LearnedTorque<Kernel> learned(constants, ticks);
    constexpr float rest[] = {0.3F, 0.4F};
    constexpr float torque[] = {20, 5};
    learned.begin(0, rest);
    float before[2];
    REQUIRE(learned.predict(0, rest, before));
    for (int t = 0; t < 12; ++t) { // until the window of measurements is full
        learned.learn(t * period_ns, rest, nullptr);
    }
    const Status status = learned.learn(12 * period_ns, rest, torque);
    REQUIRE(status.learning == Reason::learning_in_progress);
    float during[2];
    REQUIRE(learned.predict(period_ns, rest, during));
    CHECK(during[0] == before[0]);
    for (int i = 1; i < ticks; ++i) {
        learned.go_on();
    }
    float after[2];
    REQUIRE(learned.predict(2 * period_ns, rest, after));
    CHECK(after[0] == Approx(20).margin(0.1));
    CHECK(learned.tick_cost() < 2 * Estimator<Kernel>::cost().predict + Estimator<Kernel>::cost().learn);
}

TEST_CASE("a joint's prediction beyond its limit is unknown and leaves the other joint's unchanged") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<Kernel>(engine);
    const auto limited = learner_of<Kernel>(constants, engine);
    const auto unlimited = std::make_unique<LearnedTorque<Kernel>>(*limited);
    int beyond = 0;
    for (int t = 0; t < 200; ++t) {
        const auto sample = moving_sample<Kernel>(t, engine);
        float expected[2];
        float torque[2];
        constants.prediction_limit = {};
        const bool known = unlimited->predict(sample.time_ns, sample.position.data(), expected);
        constants.prediction_limit = {{3, 1e6F}};
        REQUIRE(limited->predict(sample.time_ns, sample.position.data(), torque) == known);
        REQUIRE(torque[1] == expected[1]);
        const bool exceeds = std::abs(expected[0]) > 3;
        REQUIRE(std::isnan(torque[0]) == exceeds);
        beyond += exceeds ? 1 : 0;
    }
    CHECK(beyond > 20);
}

TEST_CASE("predictions that are all beyond the model's limits are reported and give zeros") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<Kernel>(engine);
    constants.prediction_limit = {{1e-6F, 1e-6F}};
    const auto learned = learner_of<Kernel>(constants, engine);
    for (int t = 0; t < 200; ++t) {
        const auto sample = moving_sample<Kernel>(t, engine);
        float torque[] = {9, 9};
        REQUIRE_FALSE(learned->predict(sample.time_ns, sample.position.data(), torque));
        REQUIRE((torque[0] == 0 && torque[1] == 0));
    }
}

TEST_CASE("a prediction that is not finite is unknown without a limit, and zeros are given without any") {
    DFDYN_SEEDED_ENGINE(engine);
    auto constants = make_constants<Kernel>(engine);
    REQUIRE((constants.prediction_limit[0] == 0 && constants.prediction_limit[1] == 0));
    LearnedTorque<Kernel> learned(constants, 1);
    constexpr float rest[] = {0.3F, 0.4F};
    float torque[] = {9, 9};
    learned.begin(0, rest);
    REQUIRE(learned.predict(period_ns, rest, torque));
    const float good[] = {torque[0], torque[1]};
    const auto sound = constants.output_offset;
    using Limits = std::numeric_limits<float>;
    for (const float offset : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()}) {
        for (const int output : {0, 1}) {
            CAPTURE(offset, output);
            constants.output_offset = sound;
            constants.output_offset[output] = offset;
            learned.begin(0, rest);
            CHECK(learned.predict(period_ns, rest, torque));
            CHECK(std::isnan(torque[output]));
            CHECK(torque[1 - output] == good[1 - output]);
        }
        constants.output_offset = {{offset, offset}};
        torque[0] = torque[1] = 9;
        learned.begin(0, rest);
        CHECK_FALSE(learned.predict(period_ns, rest, torque));
        CHECK(torque[0] == 0);
        CHECK(torque[1] == 0);
    }
}

TEST_CASE("a NaN reference is reported, and has no effect after one window") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Kernel>(engine);
    const auto learned = learner_of<Kernel>(constants, engine);
    constexpr float rest[] = {0, 0};
    const float nothing[] = {std::numeric_limits<float>::quiet_NaN(), 0};
    float torque[2];
    learned->begin(0, rest);
    REQUIRE(learned->predict(period_ns, rest, torque));
    CHECK_FALSE(learned->predict(2 * period_ns, nothing, torque));
    CHECK(torque[0] == 0);
    constexpr int window = 7; // six lags and the present value
    for (int t = 0; t < window; ++t) {
        CHECK(learned->predict((3 + t) * period_ns, rest, torque) == (t == window - 1));
    }
}

TEST_CASE("the learned state can be saved and then restored after a restart") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Kernel>(engine);
    const auto learned = learner_of<Kernel>(constants, engine);
    std::vector<std::byte> saved(LearnedTorque<Kernel>::snapshot_capacity);
    REQUIRE(learned->snapshot(saved) == SnapshotResult::ok);
    LearnedTorque<Kernel> fresh(constants, 1);
    REQUIRE(fresh.restore(saved) == SnapshotResult::ok);
    constexpr float rest[] = {0.3F, 0.4F};
    float old_torque[2];
    float new_torque[2];
    fresh.begin(0, rest);
    learned->begin(0, rest);
    REQUIRE(learned->predict(period_ns, rest, old_torque));
    REQUIRE(fresh.predict(period_ns, rest, new_torque));
    CHECK(old_torque[0] == new_torque[0]);
    CHECK(old_torque[1] == new_torque[1]);
    saved[100] ^= std::byte{1};
    CHECK(fresh.restore(saved) != SnapshotResult::ok);
    REQUIRE(fresh.predict(2 * period_ns, rest, new_torque));
    CHECK(old_torque[0] == new_torque[0]);
    fresh.reset();
    fresh.begin(0, rest);
    REQUIRE(fresh.predict(period_ns, rest, new_torque));
    CHECK(old_torque[0] != new_torque[0]);
}

TEST_CASE("an abandoned save stops learning for its control ticks, not for as many samples") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Kernel>(engine);
    constexpr int ticks = 8; // per sample
    LearnedTorque<Kernel> learned(constants, ticks);
    auto learn_next = [&, t = 0]() mutable {
        const auto sample = moving_sample<Kernel>(t++, engine);
        const Status status = learned.learn(sample.time_ns, sample.position.data(), sample.output.data());
        for (int i = 1; i < ticks; ++i) {
            learned.go_on();
        }
        return status.learning;
    };
    for (int t = 0; t < 12; ++t) {
        learn_next(); // until the window of measurements is full
    }
    REQUIRE(learn_next() == Reason::learning_in_progress);
    const auto writer = learned.snapshot_writer(2 * ticks); // never writes
    CHECK(learn_next() == Reason::learning_held);
    CHECK(learn_next() == Reason::learning_held);
    CHECK(learn_next() == Reason::learning_in_progress);
    CHECK(writer.written() == 0);
}

TEST_CASE("learning and predicting for a reference allocate nothing") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Kernel>(engine);
    std::array<Kernel::Sample, 100> samples{};
    for (std::size_t t = 0; t < samples.size(); ++t) {
        samples[t] = moving_sample<Kernel>(static_cast<int>(t), engine);
    }
    const AllocationGuard guard;
    LearnedTorque<Kernel> learned(constants, 3);
    learned.begin(0, samples[0].position.data());
    for (const Kernel::Sample& sample : samples) {
        float torque[2];
        learned.predict(sample.time_ns, sample.position.data(), torque);
        learned.learn(sample.time_ns, sample.position.data(), sample.output.data());
        learned.go_on();
    }
    const HeapCalls calls = guard.calls();
    CHECK(calls.allocations == 0);
}

} // namespace learned_torque_test
