// SPDX-License-Identifier: Apache-2.0
// F16: stamps that jump. The bus' own time goes on.
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

TEST_CASE("F16: frames with a stray stamp are lost, not believed") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms, -100'000 * ms}) {
        const auto stray = arm.tick(shifted_by(jump));
        CHECK(stray.predicted); // positions are held
        CHECK_FALSE(stray.learned);
        CHECK(arm.ticks_to_recover() <= 2);
        CHECK(arm.run(10));
    }
    CHECK(arm.assembly.bus(0).clock.refused() == 9);
    CHECK(arm.assembly.bus(0).clock.adopted() == 0);
}

TEST_CASE("F16: a clock that was set is not followed at once, then adopted and counted") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms}) {
        ArmOnBus arm(engine);
        arm.warm_up();
        arm.clock_error_ns = ms; // the new clock is known to the age of the frame that settled it
        int doubtful = 0;
        for (int tick = 0; tick < 100; ++tick) {
            doubtful += arm.tick(shifted_by(jump)).position() == Reason::clock_jumped ? 1 : 0;
        }
        CHECK(doubtful >= 2); // after the positions held, before the clock is adopted
        CHECK(arm.assembly.bus(0).clock.adopted() == 1);
        CHECK(arm.assembly.bus(0).clock.refused() == 20);
        CHECK(arm.tick(shifted_by(jump)).good());
    }
}

TEST_CASE("F16: the same instant is not asked for twice") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto again = arm.read(); // the caller's timer fired twice
    CHECK(again.position() == Reason::time_not_increasing);
    CHECK(arm.run(10));
}
