// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/feed_forward.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/simulation/small_arms.hpp"
#include "tests/tools/support/small_model.hpp"

#include <cmath>
#include <optional>
#include <random>
#include <utility>

namespace feed_forward_of_tools_test {

using namespace dfdyn::tools;

constexpr int knot_ticks = 4;
constexpr double period_s = 0.001;
constexpr std::int64_t period_ns = 1'000'000;
constexpr double load = 5;

Reference reference_at(int tick) {
    constexpr double first = 5, second = 7.5; // rad/s
    const double time_s = tick * period_s;
    Reference result{JointVector(2), JointVector(2), JointVector(2)};
    result.position << 0.4 * std::sin(first * time_s), 0.5 * std::cos(second * time_s) - 0.5;
    result.velocity << 0.4 * first * std::cos(first * time_s), -0.5 * second * std::sin(second * time_s);
    result.acceleration << -0.4 * first * first * std::sin(first * time_s),
        -0.5 * second * second * std::cos(second * time_s);
    return result;
}

/// The feed-forward of two joints almost without mass, with the whole model and its physics alone.
FeedForward feed_forward_of(const TrainedModel& model) {
    Robot robot = dfdyn::tests::pendulum(1e-6, 0.1);
    robot.joints.push_back(robot.joints[0]);
    const JointVector one = JointVector::Constant(2, 1);
    return {robot,    0 * one,    LearnedFeedForward(model, true, 2, knot_ticks, "model"),
            period_s, knot_ticks, 20 * one,
            10 * one, 0 * one,    0 * one};
}

/// Runs ticks in which the command has to be `needed` at joint 2.
void run(FeedForward& forward, int& tick, int ticks, double needed) {
    JointVector command(2);
    command << 0, needed;
    for (const int end = tick + ticks; tick < end; ++tick) {
        const Reference reference = reference_at(tick);
        forward.update(reference);
        forward.commanded(command);
        forward.measured(tick * period_ns, &reference.position, &command, true);
    }
}

TEST_CASE(
    "shortly after a change a stop holds the arm with the forecast that is used, not with the wrong one") {
    DFDYN_SEEDED_ENGINE(engine);
    TrainedModel model = dfdyn::tests::small_physics_model(engine, "SPK", InputKind::DFR, /*wrench=*/false);
    model.outputs.prior_variance = 1; // the features' part is no larger than the noise
    FeedForward forward = feed_forward_of(model);
    int tick = 0;
    forward.begin(0, reference_at(0));
    run(forward, tick, 2000 * knot_ticks, load);
    run(forward, tick, 500 * knot_ticks, -load);
    REQUIRE(forward.learned_share()[1] > 0.5);
    Reference rest = reference_at(tick);
    rest.velocity.setZero();
    rest.acceleration.setZero();
    const JointVector at_stop = forward.holding(rest);
    JointVector held = at_stop;
    for (int i = 0; i < 20; ++i) {
        held = forward.holding(rest);
    }
    CHECK(held != at_stop); // the forecasts at rest
    CHECK(held[1] < -0.5 * load);
    CHECK(held.cwiseAbs().maxCoeff() <= 10.1);
}

} // namespace feed_forward_of_tools_test
