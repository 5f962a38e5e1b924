// SPDX-License-Identifier: Apache-2.0
// Time stamps that jump while the clock of the bus continues.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

auto shifted_by(std::int64_t jump_ns) {
    return [jump_ns](Frames& frames) {
        for (hal::Frame& frame : frames) {
            frame.stamp_ns += jump_ns;
        }
    };
}

} // namespace

TEST_CASE("fault 20: frames with an outlier as time stamp are rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms, -100'000 * ms}) {
        const auto stray = arm.tick(shifted_by(jump));
        CHECK(stray.predicted); // the last positions are held
        CHECK_FALSE(stray.learned);
        CHECK(arm.ticks_to_recover() <= 2);
        CHECK(arm.run(10));
    }
    CHECK(arm.assembly.bus().clock.refused() == 9);
    CHECK(arm.assembly.bus().clock.adopted() == 0);
}

TEST_CASE("faults 22 and 23: a clock that was set is rejected at first and then adopted and counted") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms}) {
        ArmOnBus arm(engine);
        arm.warm_up();
        // the new clock is known only to within the age of the frame that decided on it
        arm.clock_error_ns = ms;
        int doubtful = 0;
        for (int tick = 0; tick < 300; ++tick) { // twenty times as many readings as usual qualify
            doubtful += arm.tick(shifted_by(jump)).position() == Reason::clock_jumped ? 1 : 0;
        }
        CHECK(doubtful >= 2); // between the held positions and the adoption of the clock
        CHECK(arm.assembly.bus().clock.adopted() == 1);
        CHECK(arm.assembly.bus().clock.refused() == 20);
        CHECK(arm.tick(shifted_by(jump)).good());
    }
}

TEST_CASE("fault 22: no second sample is assembled for the same time") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto again = arm.read(); // the caller's timer expired twice
    CHECK(again.position() == Reason::time_not_increasing);
    CHECK(arm.run(10));
}
