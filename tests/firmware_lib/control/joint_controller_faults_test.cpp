// SPDX-License-Identifier: Apache-2.0
// The controller that users copy, with wrong readings, late ticks and efforts that are not applied.
#include "tests/firmware_lib/control/joint_controller_rig.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace joint_controller_test {

constexpr float largest_kick = JointController::kick_share * gains.limit;

/// Adds to the position of one joint.
auto off_by(float angle_rad) {
    return [angle_rad](JointController::State& state) { state.position[joint] += angle_rad; };
}

void lose_position(JointController::State& state) { state.position[joint] = nothing; }

TEST_CASE("a wrong position before a missing one has no effect that lasts") {
    for (const float wrong : {6.2832F, -6.2832F, 1e10F}) {
        CAPTURE(wrong);
        Rig rig, untouched;
        rig.go(700);
        rig.go(1, off_by(wrong));
        CHECK(rig.largest_change <= 1.01F * largest_kick);
        rig.go(1, lose_position);
        rig.go(60);
        CHECK(rig.largest_change <= 1.01F * largest_kick);
        untouched.go(762);
        CHECK(std::abs(rig.correction[joint] - untouched.correction[joint]) < largest_kick);
        rig.go(5000);
        untouched.go(5000);
        CHECK(std::abs(rig.correction[joint] - untouched.correction[joint]) < largest_kick);
    }
}

TEST_CASE("no reading changes a correction by more than its share of the limit in a tick") {
    Rig rig;
    SECTION("one position is wrong") {
        rig.go(700);
        rig.go(1, off_by(0.2F));
        CHECK(rig.largest_change > 0.9F * largest_kick);
        CHECK(rig.largest_change <= 1.01F * largest_kick);
        rig.go(50);
    }
    SECTION("the arm is not at the beginning of the reference") {
        rig.go(300, off_by(0.1F)); // from the first tick on
    }
    SECTION("the loop was late by 50 ticks") {
        rig.go(700);
        rig.sleep(50);
        rig.go(200);
    }
    SECTION("the reference has a step") {
        rig.go(700);
        rig.reference_offset = 0.05F;
        rig.go(200);
    }
    CHECK(rig.largest_change <= 1.01F * largest_kick);
}

TEST_CASE("one wrong position does not throw the observer to its limit") {
    for (const float wrong : {6.2832F, -6.2832F, 1e30F}) {
        CAPTURE(wrong);
        Rig rig;
        rig.go(700);
        const float before = rig.correction[joint];
        rig.go(1, off_by(wrong));
        rig.go(1);
        CHECK(std::abs(rig.correction[joint] - before) < largest_kick);
    }
}

TEST_CASE("an observer does not wind up while the correction ramps to a measurement that returned") {
    for (const int ticks : {20, 300}) {
        for (const float off : {0.3F, -0.3F}) {
            CAPTURE(ticks, off);
            Rig rig;
            rig.go(700);
            rig.go(ticks, lose_position);
            const auto estimate = [&] { return rig.controller.observer().estimate()[joint]; };
            const float before = estimate();
            rig.go(6, off_by(off));
            const float limit = JointController::observer_share * gains.limit;
            CHECK(std::abs(estimate() - before) < 0.1F * limit);
        }
    }
}

TEST_CASE("efforts that are not applied are neither learned nor integrated, and applied ones begin gently") {
    Rig rig;
    rig.applied = false; // the brakes are closed, and the reference moves on
    rig.go(2000);
    for (const float correction : rig.correction) {
        CHECK(correction == Approx(0).margin(1e-4));
    }
    for (const float estimate : rig.controller.observer().estimate()) {
        CHECK(estimate == 0);
    }
    CHECK(rig.controller.forward().learner().estimator().counters().learned == 0);
    rig.applied = true;
    rig.go(1);
    CHECK(rig.largest_change <= 1.01F * largest_kick);
    rig.go(1000);
    CHECK(rig.controller.forward().learner().estimator().counters().ticks > 100);
}

} // namespace joint_controller_test
