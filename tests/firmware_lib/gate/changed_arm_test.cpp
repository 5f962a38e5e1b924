// SPDX-License-Identifier: Apache-2.0
// A two-link arm that is pushed, picks up a load, or gets more friction: the estimator within the following
// seconds.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/slow_build.hpp"

#include <array>
#include <cmath>
#include <memory>

namespace changed_arm_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr double step_s = 1e-3;
constexpr std::int64_t step_ns = 1'000'000;
constexpr double noise = 0.05; // N·m
constexpr double limit = 41; // three times the value that 0.1 % of the samples with two normal errors exceed
constexpr double learned_s = 40;

using Features = Model<float, Joints<2, 2>, StandardMeasured, RandomFourier<100>, Nonparametric<>>;
using Physical = TestParametric<float, StandardMeasured>;
using Both = TestKernel<float, StandardMeasured, 30>;
using Plant = Physics<StandardMeasured, two_link_column_count, ViscousFriction<2>, OutputOffset<2>>;

/// The change of the arm.
struct Event {
    double payload_kg = 0;
    double friction = 0; ///< N·m, of each joint
    double push = 0;     ///< N·m at joint 2
    double push_s = 0;
};

/// The torques of the two links, with a load on the second link at 0.3 m.
class TwoLinks {
  public:
    TwoLinks() {
        set_two_links(constants_.chain);
        constants_.effects = {{{{0, 1}}}, {{{0, 1}}}};
        std::ranges::copy(two_link_columns, constants_.selected.begin());
        std::ranges::fill(constants_.column_scale, 1);
        constants_.output_gain = {{1, 1}};
    }

    [[nodiscard]] std::array<double, 2> torques(const ArmState& arm, const Event& event) const {
        auto parameters = two_link_parameters;
        constexpr double reach = 0.3;
        parameters[0] += event.payload_kg * first_link_length;
        parameters[2] += event.payload_kg * first_link_length * first_link_length;
        parameters[3] += event.payload_kg * reach;
        parameters[5] += event.payload_kg * reach * reach;
        const double xi[] = {arm.position[0], arm.velocity[0], arm.acceleration[0],
                             arm.position[1], arm.velocity[1], arm.acceleration[1]};
        double psi[2 * two_link_column_count];
        Plant::evaluate_rows<Chain<2>>(constants_, {}, xi, psi);
        std::array<double, 2> torques{};
        for (std::size_t k = 0; k < 2; ++k) {
            for (std::size_t c = 0; c < parameters.size(); ++c) {
                torques[k] += psi[k * parameters.size() + c] * parameters[c];
            }
            torques[k] += event.friction * std::tanh(arm.velocity[k] / 0.5);
        }
        return torques;
    }

  private:
    Plant::Constants<double, Chain<2>> constants_{};
};

/// An estimator of such an arm at 1 kHz.
template <class Model>
class Arm {
  public:
    explicit Arm(std::mt19937_64 engine) : engine_(engine), constants_(constants(engine)) {}

    /// Continues for `duration_s`. Returns the root mean square error of the predictions, relative to the arm
    /// without the push, in units of the noise, over the last 2.5 s.
    double run(double duration_s, const Event& event) {
        const long last = now_ + std::lround(duration_s / step_s);
        const long pushed_until = now_ + std::lround(event.push_s / step_s);
        double square = 0;
        long count = 0;
        for (; now_ < last; ++now_) {
            const std::array<double, 2> truth = tick(event, now_ < pushed_until ? event.push : 0);
            for (int k = 0; k < 2 && now_ >= last - 2500; ++k, ++count) {
                const double error =
                    static_cast<double>(estimate_.prediction[k]) - truth[static_cast<std::size_t>(k)];
                square += error * error;
            }
        }
        return std::sqrt(square / static_cast<double>(count)) / noise;
    }

    [[nodiscard]] std::uint64_t refused() const {
        return estimator_->counters().reasons[static_cast<int>(Reason::innovation_too_large)];
    }

  private:
    static typename Model::Constants constants(std::mt19937_64& engine) {
        auto constants = make_constants<Model>(engine, 0.9999);
        constants.gap_ns = step_ns * 3 / 2;
        constants.innovation_limit = static_cast<float>(limit);
        constants.innovation_patience = 1500;
        constants.output_noise_std = {{static_cast<float>(noise), static_cast<float>(noise)}};
        constants.output_limit = {{1000, 1000}};
        return constants;
    }

    std::array<double, 2> tick(const Event& event, double push) {
        const ArmState state = moving_arm(step_s * static_cast<double>(now_));
        const std::array<double, 2> truth = plant_.torques(state, event);
        typename Model::Sample sample{};
        sample.time_ns = now_ * step_ns;
        sample.output_valid = true;
        for (int i = 0; i < 2; ++i) {
            const auto joint = static_cast<std::size_t>(i);
            sample.position[i] = static_cast<float>(state.position[joint]);
            sample.velocity[i] = static_cast<float>(state.velocity[joint]);
            sample.acceleration[i] = static_cast<float>(state.acceleration[joint]);
            sample.output[i] =
                static_cast<float>(truth[joint] + noise * normal_(engine_) + (i == 1 ? push : 0));
        }
        estimate_ = estimator_->tick(sample, Budget::unlimited());
        return truth;
    }

    std::mt19937_64 engine_;
    std::normal_distribution<double> normal_;
    TwoLinks plant_;
    typename Model::Constants constants_;
    std::unique_ptr<Estimator<Model>> estimator_ = std::make_unique<Estimator<Model>>(constants_);
    typename Estimator<Model>::Estimate estimate_{};
    long now_ = 0;
};

TEMPLATE_TEST_CASE("a load of 1 kg is learned to twice the noise within 10 s of motion", "", Features,
                   Physical, Both) {
    DFDYN_SEEDED_ENGINE(engine);
    Arm<TestType> arm(engine);
    CHECK(arm.run(learned_s, {}) < 1);
    CHECK(arm.refused() == 0);
    CHECK(arm.run(10, {.payload_kg = 1}) < 2);
    CHECK(arm.refused() < 1600); // the patience, and plausible samples at reversals
    CHECK(arm.run(10, {.payload_kg = 1}) < 2);
    CHECK(arm.refused() < 1600);
}

TEST_CASE("a friction step of 10 noise deviations is learned to twice the noise within 10 s") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm<Features> arm(engine);
    arm.run(learned_s, {});
    CHECK(arm.run(10, {.friction = 10 * noise}) < 2);
}

TEMPLATE_TEST_CASE("a push of one second leaves less than 5 % of extra error behind", "", Features, Physical,
                   Both) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double deviations : {30, 12, 100}) {
        if (slow_build && deviations != 30) {
            continue;
        }
        CAPTURE(deviations);
        Arm<TestType> pushed(engine);
        Arm<TestType> left_alone(engine);
        pushed.run(learned_s, {});
        left_alone.run(learned_s, {});
        const double with = pushed.run(3.5, {.push = deviations * noise, .push_s = 1});
        const double without = left_alone.run(3.5, {});
        // Relative to the error of a measurement: its noise and the model error.
        CHECK(std::hypot(1, with) < 1.05 * std::hypot(1, without));
    }
}

} // namespace changed_arm_test
