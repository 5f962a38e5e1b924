// SPDX-License-Identifier: Apache-2.0
// The controller that users copy, without some of its measurements.
#include "tests/firmware_lib/control/joint_controller_rig.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace joint_controller_test {

TEST_CASE("a controller with unusable gains commands nothing, and none is copied") {
    STATIC_REQUIRE_FALSE(std::is_copy_constructible_v<JointController>);
    STATIC_REQUIRE_FALSE(std::is_copy_assignable_v<JointController>);
    REQUIRE(JointController(gains).valid());
    for (float JointController::Gains::*gain :
         {&JointController::Gains::position, &JointController::Gains::velocity,
          &JointController::Gains::inertia, &JointController::Gains::limit,
          &JointController::Gains::bandwidth}) {
        for (const float wrong : {nothing, std::numeric_limits<float>::infinity(), -1.0F}) {
            JointController::Gains unusable = gains;
            unusable.*gain = wrong;
            JointController controller(unusable);
            CHECK_FALSE(controller.valid());
            const SimulatedJoints arm;
            controller.activate(arm.state());
            const JointController::Reference reference = SimulatedJoints::reference(100);
            const JointController::Efforts& effort =
                controller.update(arm.state(), reference, SimulatedJoints::nominal(reference));
            CHECK(std::ranges::all_of(effort, [](float one) { return one == 0; }));
        }
    }
}

TEST_CASE("a controller refuses a bandwidth of its observer that its period does not permit") {
    JointController::Gains fast = gains;
    fast.bandwidth = 0.99F * 1e9F / JointController::period_ns;
    CHECK(JointController(fast).valid());
    fast.bandwidth = 1.01F * 1e9F / JointController::period_ns;
    CHECK_FALSE(JointController(fast).valid());
}

TEST_CASE("a joint without position keeps its correction and returns to it without a step") {
    Rig rig;
    rig.go(700);
    const float before = rig.correction[joint];
    REQUIRE(std::abs(before) > 3 * largest_step); // to drop it would be a step
    const auto lose = [](JointController::State& state) { state.position[joint] = nothing; };
    rig.go(JointController::hold_ticks, lose);
    CHECK(rig.correction[joint] == Approx(before).margin(1e-4));
    CHECK(rig.controller.ticks_without_sample(joint) == JointController::hold_ticks);
    CHECK(rig.controller.ticks_without_sample(0) == 0);
    CHECK(rig.largest_change < largest_step);
    rig.go(500);
    CHECK(rig.largest_change <= 1.01F * largest_step);
    CHECK(rig.controller.ticks_without_sample(joint) == 0);
}

TEST_CASE("after a long gap of positions the correction ramps to zero without a step") {
    Rig rig;
    rig.go(700);
    REQUIRE(std::abs(rig.correction[joint]) > 3 * largest_step);
    rig.go(200, [](JointController::State& state) { state.position[joint] = nothing; });
    CHECK(rig.correction[joint] == Approx(0).margin(1e-4));
    CHECK(rig.largest_change <= 1.01F * largest_step);
    CHECK(rig.controller.ticks_without_sample(joint) == 200);
}

TEST_CASE("a repeated sample is not a new measurement") {
    Rig rig;
    rig.go(700);
    const JointController::Efforts before = rig.correction;
    JointController::State old{};
    rig.go(1, [&old](JointController::State& state) { old = state; });
    const JointController::Efforts last = rig.correction;
    REQUIRE(std::abs(last[joint] - before[joint]) > 1e-4F); // a new measurement changes the correction
    rig.go(JointController::hold_ticks, [&old](JointController::State& state) { state = old; });
    CHECK(rig.correction[joint] == Approx(last[joint]).margin(1e-4));
    CHECK(rig.controller.ticks_without_sample(0) == JointController::hold_ticks);
}

TEST_CASE("a single wrong stamp costs one measurement") {
    constexpr std::int64_t hour_ns = 3'600'000'000'000;
    for (const std::int64_t away : {hour_ns, -hour_ns, std::numeric_limits<std::int64_t>::max() / 2}) {
        CAPTURE(away);
        Rig rig;
        rig.go(700);
        rig.go(1, [away](JointController::State& state) { state.time_ns += away; });
        CHECK(rig.controller.ticks_without_sample(joint) == 1);
        rig.go(1);
        CHECK(rig.controller.ticks_without_sample(joint) == 0);
    }
}

TEST_CASE("stamps are accepted again within a few measurements after the clock was set") {
    constexpr std::int64_t hour_ns = 3'600'000'000'000;
    for (const std::int64_t away : {hour_ns, -hour_ns}) {
        CAPTURE(away);
        Rig rig;
        rig.go(700);
        const auto set = [away](JointController::State& state) { state.time_ns += away; };
        rig.go(StampClock::agreeing - 1, set);
        CHECK(rig.controller.ticks_without_sample(joint) == StampClock::agreeing - 1);
        rig.go(1, set);
        CHECK(rig.controller.ticks_without_sample(joint) == 0);
        CHECK(rig.largest_change < largest_step);
    }
}

TEST_CASE("a new controller restores the learned state of another one") {
    Rig rig;
    rig.go(3000);
    std::vector<std::byte> snapshot(JointController::Learned::snapshot_capacity);
    auto writer = rig.controller.snapshot_writer();
    constexpr std::size_t bytes_per_tick = 64;
    for (int i = 0; i < 10'000 && writer.result() == dfdyn::SnapshotResult::in_progress; ++i) {
        static_cast<void>(writer.step(snapshot, bytes_per_tick));
        rig.go(1); // as an interrupt between two pieces
    }
    REQUIRE(writer.result() == dfdyn::SnapshotResult::ok);
    Rig next;
    const std::span<const std::byte> written(snapshot.data(), writer.bytes());
    CHECK(next.controller.restore(written.first(written.size() - 1)) != dfdyn::SnapshotResult::ok);
    CHECK(next.controller.restore(written) == dfdyn::SnapshotResult::ok);
    std::vector<std::byte> again(snapshot.size());
    REQUIRE(next.controller.forward().learner().snapshot(again) == dfdyn::SnapshotResult::ok);
    again.resize(writer.bytes());
    snapshot.resize(writer.bytes());
    CHECK(again == snapshot);
}

TEST_CASE("the reference of the example is smooth for hours") {
    for (const std::int64_t hours : {0, 1, 24, 1000}) {
        JointController::Reference before = SimulatedJoints::reference(hours * 3'600'000);
        float largest = 0, highest = 0;
        for (std::int64_t tick = 1; tick <= 3000; ++tick) {
            const JointController::Reference now = SimulatedJoints::reference(hours * 3'600'000 + tick);
            const float step = now.position[5] - before.position[5];
            largest = std::max(largest, std::abs(step - 0.001F * now.velocity[5]));
            highest = std::max(highest, now.position[5]);
            before = now;
        }
        CAPTURE(hours);
        CHECK(highest > 0.8F);
        CHECK(largest < 1e-5F);
    }
}

} // namespace joint_controller_test
