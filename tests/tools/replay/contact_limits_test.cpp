// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_limits.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/replay/recorded_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace contact_limits_test {

using namespace dfdyn::tools;
using dfdyn::tests::small_model;

constexpr double period_s = 0.004;
constexpr int rows_of_stretch = 75; // 0.3 s

/// A model of two torques that are noise of deviation 1 about 1: it learns nothing from them.
TrainedModel noise_model(std::mt19937_64& engine) {
    TrainedModel model = small_model(engine, InputKind::DFR);
    model.forgetting_factor = 1;
    model.outputs = {{"tau1", "tau2"}, {1, 1}, {1, 1}, 1};
    model.limits.output = {100, 100};
    model.start.weights.assign(12, 0);
    return model;
}

/// Two joints and their torques.
struct Recorded {
    Recording recording;

    Recorded() {
        recording.source = "torques.csv";
        recording.position.names = joint_names("q", 2);
        recording.output.names = output_names(OutputKind::joint_torque, 2);
    }

    void add(bool gap_before, std::array<double, 2> position, std::array<double, 2> torque) {
        const auto row = static_cast<int>(recording.time_s.size());
        recording.time_s.push_back(period_s * row);
        recording.time_ns.push_back(std::int64_t{4'000'000} * row);
        recording.gap_before.push_back(gap_before ? 1 : 0);
        recording.position.values.insert(recording.position.values.end(), position.begin(), position.end());
        recording.output.values.insert(recording.output.values.end(), torque.begin(), torque.end());
    }
};

/// A moving arm whose torques are such noise. There is a gap before each stretch.
Recording noise_in_stretches(int stretches, std::mt19937_64& engine) {
    std::normal_distribution<double> torque(1, 1);
    Recorded recorded;
    for (int row = 0; row < stretches * rows_of_stretch; ++row) {
        const double t = period_s * row;
        recorded.add(row % rows_of_stretch == 0, {std::sin(3 * t), std::cos(5 * t)},
                     {torque(engine), torque(engine)});
    }
    return recorded.recording;
}

/// Counts the stretches in which the excess reaches 1, and the predicted rows.
struct Exceeded {
    int stretches = 0, rows = 0;
};

Exceeded exceeded(const TrainedModel& model, const ContactModel& contact, const Recording& recording) {
    Exceeded result;
    ContactWatch watch({contact});
    bool counted = false;
    std::vector<float> position(2);
    const auto count = [&](const MeasuredSample& sample, const Tick& tick, bool begins) {
        if (begins || !tick.status.estimated()) {
            watch.interrupt();
            counted = false;
        }
        if (!tick.status.estimated()) {
            return;
        }
        ++result.rows;
        std::ranges::transform(sample.position, position.begin(),
                               [](double x) { return static_cast<float>(x); });
        watch.tick(sample.time_ns, position, prediction_errors(sample, tick), tick.prediction,
                   tick.standard_deviation);
        if (!counted && watch.detector().excess() >= 1) {
            ++result.stretches;
            counted = true;
        }
    };
    const auto estimator = make_estimator(model, false);
    tick_rows(*estimator, {&recording, 1}, 0, recording.row_count(), dfdyn::Budget::predict_only(), count);
    return result;
}

TEST_CASE("gaps in the training leave the number of false contacts per hour as promised", "[contacts]") {
    constexpr double new_motions = 1.08; // the allowance for motions that the training did not have
    constexpr double per_hour = 800;
    std::mt19937_64 engine(1);
    TrainedModel model = noise_model(engine);
    const Recording training = noise_in_stretches(600, engine);
    const ContactModel contact = measure_contact_limits(model, {&training, 1});
    const Recording other = noise_in_stretches(3000, engine);
    const Exceeded found =
        exceeded(model, scaled_contact(contact_at_rate(contact, per_hour), 1 / new_motions), other);
    const double promised = per_hour * found.rows * period_s / 3600;
    CAPTURE(found.stretches, promised);
    CHECK(found.stretches < 1.8 * promised);
    CHECK(found.stretches > 0.5 * promised);
}

TEST_CASE("limits of contacts are also measured where predictions are at the model's bound", "[contacts]") {
    std::mt19937_64 engine(1);
    TrainedModel model = noise_model(engine);
    model.limits.prediction = {0.2, 0.2}; // of predictions near 1
    const Recording training = noise_in_stretches(20, engine);
    const ContactModel contact = measure_contact_limits(model, {&training, 1});
    REQUIRE(contact.usual.size() == 6);
    CHECK(*std::ranges::max_element(contact.usual) > 0.01);
}

/// An arm that moves and rests, each for a second. At rest the first torque keeps this friction of its last
/// motion, which the model does not have.
Recording friction_at_rest(double friction, std::mt19937_64& engine) {
    std::normal_distribution<double> torque(1, 0.1);
    Recorded recorded;
    double position = 0;
    double direction = 1;
    for (int row = 0; row < 60'000; ++row) {
        const bool moves = row / 250 % 2 == 0;
        if (row % 500 == 0) {
            const double forwards = position > 1 ? 0 : position < -1 ? 1 : 0.5; // probability
            direction = std::bernoulli_distribution(forwards)(engine) ? 1 : -1;
        }
        position += moves ? direction * 0.5 * period_s : 0;
        const double kept = moves ? 0 : direction * friction;
        recorded.add(false, {position, position}, {torque(engine) + kept, torque(engine)});
    }
    return recorded.recording;
}

TEST_CASE("the friction that a joint keeps at rest is measured, and of another joint none", "[contacts]") {
    constexpr double friction = 2;
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = noise_model(engine);
    const Recording training = friction_at_rest(friction, engine);
    const ContactModel contact = measure_contact_limits(model, {&training, 1});
    REQUIRE(contact.hysteresis.size() == 2);
    CHECK(contact.hysteresis[0] > 0.7 * friction);
    CHECK(contact.hysteresis[0] < 1.5 * friction);
    CHECK(contact.hysteresis[1] == 0);
}

} // namespace contact_limits_test
