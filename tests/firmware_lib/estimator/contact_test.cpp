// SPDX-License-Identifier: Apache-2.0
// Measurements that contradict the model: a contact is not learned, a change of the arm is.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/running_arm.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace estimator_contact_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int patience = 5;

/// An arm whose estimator refuses samples beyond 25 noise variances. It has learned 2,000 samples.
template <class Model>
struct WatchfulArm : RunningArm<Model> {
    explicit WatchfulArm(std::mt19937_64& engine) : RunningArm<Model>(engine, watchful(engine)) {
        for (int t = 0; t < 2000; ++t) {
            this->tick(this->due());
        }
    }

    static typename Model::Constants watchful(std::mt19937_64& engine) {
        auto constants = make_constants<Model>(engine);
        constants.innovation_limit = 25;
        constants.innovation_patience = patience;
        return constants;
    }

    /// Returns the next sample, with an external torque at joint 2.
    typename Model::Sample touched(double torque) {
        auto sample = this->due();
        sample.output[1] += static_cast<typename Model::Scalar>(torque);
        return sample;
    }
};

using UdFloat = TestModel<float, DerivativeFreeReduced<6, 3>, 60>;

TEMPLATE_TEST_CASE("a short contact is predicted and reported but not learned", "", UdFloat) {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    for (int contact = 0; contact < 4; ++contact) {
        for (int t = 0; t < patience; ++t) {
            CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
        }
        for (int t = 0; t < patience; ++t) {
            CHECK(arm.tick(arm.due()) == Reason::ok);
        }
    }
    const auto estimate = arm.estimator.tick(arm.touched(5), Budget::unlimited());
    CHECK(estimate.status.predicted());
    CHECK(static_cast<double>(estimate.innovation[1]) == Approx(5).margin(0.5));
    CHECK(static_cast<double>(estimate.normalised_innovation_squared) == Approx(62.5 * 62.5).epsilon(0.3));
}

TEMPLATE_TEST_CASE("a push that the caller keeps from being learned is no change of the arm at any length",
                   "", UdFloat) {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    for (int t = 0; t < 20 * patience; ++t) {
        const auto status = arm.estimator.tick(arm.touched(5), Budget::predict_only()).status;
        REQUIRE(status.learning == Reason::innovation_too_large);
    }
    const auto learned = snapshot_of(arm.estimator);
    CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
    CHECK(snapshot_of(arm.estimator) == learned);
}

TEMPLATE_TEST_CASE("a sample is learned if and only if the gate accepts it", "", UdFloat) {
    using Scalar = typename TestType::Scalar;
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    InnovationGate<Scalar> gate(25, patience);
    int changes = 0;
    double torque = 0;
    for (int t = 0; t < 1500; ++t) {
        torque = engine() % 8 == 0 ? (engine() % 5 == 0 ? 5 : 0) : torque;
        const auto before = snapshot_of(arm.estimator);
        const auto estimate = arm.estimator.tick(arm.touched(torque), Budget::unlimited());
        const bool to_learn = gate.judge(estimate.normalised_innovation_squared) > 0;
        changes += gate.take_change() ? 1 : 0;
        REQUIRE(estimate.status.learning == (to_learn ? Reason::ok : Reason::innovation_too_large));
        REQUIRE((snapshot_of(arm.estimator) != before) == to_learn);
    }
    CHECK(changes > 1);
    CHECK(arm.estimator.counters().reasons[static_cast<int>(Reason::innovation_too_large)] > 20);
}

TEMPLATE_TEST_CASE("after a change of the arm the prediction stays and its variance grows to the prior's", "",
                   UdFloat) {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    const auto predicted = [&] {
        auto blind = arm.due();
        blind.output_valid = false;
        return arm.estimator.tick(blind, Budget::unlimited());
    };
    const auto before = predicted();
    for (int t = 0; t < patience; ++t) {
        CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
    }
    const auto certain = predicted();
    CHECK(arm.tick(arm.touched(5)) == Reason::ok);
    const auto after = predicted();
    CHECK(static_cast<double>(certain.standard_deviation[0]) ==
          Approx(static_cast<double>(before.standard_deviation[0])).epsilon(0.1));
    CHECK(5 * after.standard_deviation[0] > 6 * certain.standard_deviation[0]);
    CHECK(static_cast<double>(after.prediction[0]) ==
          Approx(static_cast<double>(certain.prediction[0])).margin(0.5));
}

TEST_CASE("samples that are refused or have no output neither end a contact nor prolong it") {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<UdFloat> arm(engine);
    for (int t = 0; t < patience; ++t) {
        CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
        auto blind = arm.due();
        blind.output_valid = false;
        CHECK(arm.refused(blind) == Reason::output_missing);
        CHECK(arm.refused(blind) == Reason::time_not_increasing);
    }
    CHECK(arm.tick(arm.touched(5)) == Reason::ok);
}

TEST_CASE("a new window starts with an empty count") {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<UdFloat> arm(engine);
    for (int t = 0; t < patience; ++t) {
        arm.tick(arm.touched(5));
    }
    arm.estimator.restart_window();
    arm.ticks_to_recover();
    CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
}

// The limit applies to the innovation relative to its own variance, so an untrained model contradicts
// nothing.
TEST_CASE("an estimator that has not learned yet refuses nothing") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = WatchfulArm<UdFloat>::watchful(engine);
    Estimator<UdFloat> estimator(constants);
    for (int t = 0; t < 6; ++t) {
        estimator.tick(moving_sample<UdFloat>(t, engine), Budget::unlimited());
    }
    auto sample = moving_sample<UdFloat>(6, engine);
    sample.output[1] += 5; // 60 times the noise, but below twice the prior's deviation of 32 times the noise
    CHECK(estimator.tick(sample, Budget::unlimited()).status.learned());
}

TEST_CASE("an invalid limit refuses all samples for the patience and gives finite estimates") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const float limit : {-1.0F, 0.0F, std::nanf("")}) {
        auto constants = make_constants<UdFloat>(engine);
        constants.innovation_limit = limit;
        constants.innovation_patience = patience;
        Estimator<UdFloat> estimator(constants);
        for (int t = 0; t < 200; ++t) {
            auto sample = moving_sample<UdFloat>(t, engine);
            sample.output[0] = engine() % 3 == 0 ? std::numeric_limits<float>::infinity() : sample.output[0];
            const auto estimate = estimator.tick(sample, Budget::unlimited());
            if (estimate.status.predicted()) {
                CHECK(std::isfinite(estimate.normalised_innovation_squared));
                CHECK(std::isfinite(estimate.prediction[0]));
                CHECK(std::isfinite(estimate.standard_deviation[0]));
                CHECK(std::isfinite(estimate.innovation[0]));
            }
        }
        CHECK(estimator.counters().reasons[static_cast<int>(Reason::innovation_too_large)] == patience);
        CHECK(estimator.counters().learned > 100);
    }
}

TEMPLATE_TEST_CASE("no prediction is beyond its limit, and its deviation covers the difference", "",
                   UdFloat) {
    using Model = TestType;
    using Scalar = typename Model::Scalar;
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = make_constants<Model>(engine);
    std::vector<typename Model::Sample> samples;
    std::vector<typename Estimator<Model>::Estimate> own;
    std::vector<Scalar> magnitudes;
    Estimator<Model> free(constants);
    for (int t = 0; t < 600; ++t) {
        samples.push_back(moving_sample<Model>(t, engine));
        own.push_back(free.tick(samples.back(), Budget::unlimited()));
        magnitudes.push_back(std::abs(own.back().prediction[1]));
    }
    std::ranges::nth_element(magnitudes, magnitudes.begin() + 300);
    const Scalar limit = magnitudes[300]; // half of the predictions exceed it
    auto bounded_constants = constants;
    bounded_constants.prediction_limit = {{0, limit}};
    Estimator<Model> bounded(bounded_constants);
    int beyond = 0;
    for (std::size_t t = 0; t < samples.size(); ++t) {
        const auto estimate = bounded.tick(samples[t], Budget::unlimited());
        const Scalar bound = own[t].prediction[1] > 0 ? limit : -limit;
        const bool moved = std::abs(own[t].prediction[1]) > limit;
        REQUIRE(estimate.status.estimated() == own[t].status.predicted());
        REQUIRE(estimate.status.learned() == own[t].status.learned());
        REQUIRE(estimate.prediction[0] == own[t].prediction[0]);
        REQUIRE(estimate.prediction[1] == (moved ? bound : own[t].prediction[1]));
        REQUIRE((estimate.status.prediction == Reason::prediction_bounded) == moved);
        const Scalar least = moved ? std::abs(own[t].prediction[1] - bound) : Scalar(0);
        REQUIRE(estimate.standard_deviation[1] == std::max(own[t].standard_deviation[1], least));
        beyond += moved ? 1 : 0;
    }
    CHECK(beyond > 250);
    CHECK((snapshot_of(free) == snapshot_of(bounded)));
}

} // namespace estimator_contact_test
