// SPDX-License-Identifier: Apache-2.0
// Faults that devices report themselves.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

/// A STATUS of the joints' board at the beginning of the tick.
auto with_status(std::uint8_t flags_a, std::uint8_t flags_b) {
    return [=](Frames& frames) {
        frames.insert(frames.begin(),
                      frame_of(0x113, {flags_a, 0, flags_b, 0, 0, 0, 0, 0}, frames[0].stamp_ns - 50 * us));
    };
}

} // namespace

TEST_CASE("an encoder with an error reported by its board has no positions and its joint is named") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto first = arm.tick(with_status(0, 0x20));
    CHECK(first.position() == Reason::encoder_fault);
    for (int tick = 0; tick < 20; ++tick) {
        const auto faulty = arm.tick();
        CHECK(faulty.position() == Reason::encoder_fault);
        CHECK(faulty.assembled.report.joint == 1);
        CHECK_FALSE(faulty.predicted);
    }
    const auto cleared = arm.tick(with_status(0, 0));
    CHECK_FALSE(cleared.predicted);
    const int ticks = arm.ticks_to_recover(); // it qualifies again, then the window fills
    CHECK(ticks >= ArmOnBus::qualification_ticks + ArmOnBus::lags - 1);
    CHECK(ticks <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 1);
    CHECK(arm.run(20));
}

TEST_CASE("faults of the encoders and of the sensor are reported independently") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.tick([](Frames& frames) { // the cable is broken
        frames.resize(1);
        with_status(0x20, 0)(frames);
    });
    for (int tick = 0; tick < 20; ++tick) {
        const auto torn = arm.tick([](Frames& frames) { frames.resize(1); });
        CHECK(torn.position() == Reason::encoder_fault);
        CHECK(torn.output() == (tick < 1 ? Reason::output_not_new : Reason::output_stale));
    }
}
