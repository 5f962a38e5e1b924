// SPDX-License-Identifier: Apache-2.0
// Measurements that contradict the model: a contact is not learned, an arm that has changed is.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/running_arm.hpp"
#include "tests/support/seed.hpp"

namespace estimator_contact_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int patience = 5;

/// An arm whose estimator refuses samples of more than 25 noise variances. It has learned 2,000 samples.
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

    /// The sample due next, with an external torque at joint 2.
    typename Model::Sample touched(double torque) {
        auto sample = this->due();
        sample.output[1] += static_cast<typename Model::Scalar>(torque);
        return sample;
    }
};

template <class Scalar, template <class, int, int> class Form>
using ModelOf = TestModel<Scalar, DerivativeFreeReduced<6, 3>, 60, Form>;
using UdFloat = ModelOf<float, UdCovariance>;
using InformationDouble = ModelOf<double, CholeskyInformation>;

TEMPLATE_TEST_CASE("a short contact is predicted, shown and not learned", "", UdFloat, InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    for (int contact = 0; contact < 4; ++contact) {
        for (int t = 0; t < patience; ++t) {
            CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
        }
        CHECK(arm.tick(arm.due()) == Reason::ok);
    }
    const auto estimate = arm.estimator.tick(arm.touched(5), Budget::unlimited());
    CHECK(estimate.status.predicted());
    CHECK(static_cast<double>(estimate.innovation[1]) == Approx(5).margin(0.5));
    CHECK(static_cast<double>(estimate.normalised_innovation_squared) == Approx(62.5 * 62.5).epsilon(0.3));
}

TEMPLATE_TEST_CASE("a sample is learned if it is plausible or follows enough that are not", "", UdFloat,
                   InformationDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<TestType> arm(engine);
    int implausible_in_a_row = 0;
    int learned = 0;
    double torque = 0;
    for (int t = 0; t < 600; ++t) {
        torque = engine() % 10 == 0 ? static_cast<double>(engine() % 3) * 5 : torque;
        const auto before = snapshot_of(arm.estimator);
        const auto estimate = arm.estimator.tick(arm.touched(torque), Budget::unlimited());
        implausible_in_a_row = estimate.normalised_innovation_squared > 25 ? implausible_in_a_row + 1 : 0;
        const bool to_learn = implausible_in_a_row == 0 || implausible_in_a_row > patience;
        REQUIRE(estimate.status.learning == (to_learn ? Reason::ok : Reason::innovation_too_large));
        REQUIRE((snapshot_of(arm.estimator) != before) == to_learn);
        learned += implausible_in_a_row > patience ? 1 : 0;
    }
    CHECK(learned > 10);
    CHECK(arm.estimator.counters().reasons[static_cast<int>(Reason::innovation_too_large)] > 20);
}

TEST_CASE("samples without an output, or refused ones, neither end a contact nor prolong it") {
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

TEST_CASE("a new window begins with new patience") {
    DFDYN_SEEDED_ENGINE(engine);
    WatchfulArm<UdFloat> arm(engine);
    for (int t = 0; t < patience; ++t) {
        arm.tick(arm.touched(5));
    }
    arm.estimator.restart_window();
    arm.ticks_to_recover();
    CHECK(arm.refused(arm.touched(5)) == Reason::innovation_too_large);
}

// The limit is on the innovation over its own variance: where the model knows nothing, nothing contradicts
// it.
TEST_CASE("an estimator that has learned nothing yet refuses nothing") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = WatchfulArm<UdFloat>::watchful(engine);
    Estimator<UdFloat> estimator(constants);
    for (int t = 0; t < 6; ++t) {
        estimator.tick(moving_sample<UdFloat>(t, engine), Budget::unlimited());
    }
    auto sample = moving_sample<UdFloat>(6, engine);
    sample.output[1] +=
        5; // 60 times the noise, but less than twice the prior's deviation of 32 times the noise
    CHECK(estimator.tick(sample, Budget::unlimited()).status.learned());
}

} // namespace estimator_contact_test
