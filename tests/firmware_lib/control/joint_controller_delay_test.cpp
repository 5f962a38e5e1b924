// SPDX-License-Identifier: Apache-2.0
// The controller that users copy, with measurements that arrive late.
#include "tests/firmware_lib/control/joint_controller_rig.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace joint_controller_test {

constexpr int late = 4; // ticks
using Late = DelayedJointController<late>;

Late::Gains late_gains() {
    return {gains.position, gains.velocity, gains.inertia, gains.limit, gains.bandwidth};
}

std::vector<float> learned_weights(const JointController::Learned& learner) {
    const auto& regression = learner.estimator().regression();
    std::vector<float> weights(static_cast<std::size_t>(regression.weight_count()));
    regression.copy_weights(weights.data());
    return weights;
}

float largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
    float largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        largest = std::max(largest, std::abs(a[i] - b[i]));
    }
    return largest;
}

TEST_CASE("a delay line returns the value of so many calls ago") {
    DelayLine<int, 0> none;
    CHECK(none.pass(7) == 7);
    DelayLine<int, 3> line;
    line.fill(-1);
    const std::vector<int> expected{-1, -1, -1, 0, 1, 2, 3, 4};
    for (int i = 0; i < 8; ++i) {
        CHECK(line.pass(i) == expected[static_cast<std::size_t>(i)]);
    }
}

TEST_CASE("late measurements are compared with the reference of their time") {
    Late controller(late_gains());
    controller.activate({-late * Late::period_ns, {}, {}});
    float largest = 0;
    for (std::int64_t tick = 0; tick < 700; ++tick) {
        const std::int64_t then = tick - late;
        // an arm that follows exactly, from rest
        const Late::Reference arm = SimulatedJoints::reference(std::max<std::int64_t>(then, 0));
        const Late::Reference reference = SimulatedJoints::reference(tick);
        const Late::Efforts nominal = SimulatedJoints::nominal(reference);
        const Late::Efforts& effort =
            controller.update({then * Late::period_ns, arm.position, arm.velocity}, reference, nominal);
        for (int k = 0; k < Late::joints; ++k) {
            largest = std::max(largest, std::abs(effort[k] - nominal[k]));
        }
    }
    CHECK(largest < 1e-3F);
}

TEST_CASE("late positions are learned with the efforts that were in effect at their time") {
    constexpr int ticks = 2000;
    SimulatedJoints arm;
    std::vector<Late::State> states; // of each tick, from `late` ticks before the first on
    for (int i = 0; i < late; ++i) {
        states.push_back({(i - late) * Late::period_ns, arm.state().position, arm.state().velocity});
    }
    std::vector<Late::Efforts> efforts(late + 1); // of each tick, from `late` + 1 ticks before the first on
    const auto controller = std::make_unique<Late>(late_gains());
    const auto expected = std::make_unique<Late::Learned>(ur5_model::constants, Late::ticks_per_sample);
    controller->relearn();
    controller->activate(states.front());
    expected->relearn();
    expected->begin(states.front().time_ns, states.front().position.data());
    const std::vector<float> start = learned_weights(*expected);
    for (std::size_t tick = 0; tick < ticks; ++tick) {
        const Late::Reference reference = SimulatedJoints::reference(static_cast<std::int64_t>(tick));
        const JointController::State& now = arm.state();
        states.push_back({now.time_ns, now.position, now.velocity});
        efforts.push_back(controller->update(states[tick], reference, SimulatedJoints::nominal(reference)));
        if (tick % Late::ticks_per_sample == 0) {
            expected->learn(states[tick].time_ns, states[tick].position.data(), efforts[tick].data());
        } else {
            expected->go_on();
        }
        arm.advance(efforts.back());
    }
    CHECK(expected->estimator().counters().learned > 100);
    const std::vector<float> weights = learned_weights(*expected);
    CHECK(largest_difference(weights, start) > 0.1F);
    CHECK(largest_difference(weights, learned_weights(controller->forward().learner())) < 1e-3F);
}

} // namespace joint_controller_test
