// SPDX-License-Identifier: Apache-2.0
// Faults of the controller and its interface: their effect on the samples, given the state and counters of
// the bus. The socket tests check the other properties:
// - error frames are requested and read with their own size.
// - bus-off, ENOBUFS, dropped frames and a lost interface set state and counters.
// - the clock that stamps a frame, and the conversion of the time stamp.
// - the flags of a frame give its origin.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::BusState;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

hal::Frame error_frame(std::uint32_t error_class, std::int64_t stamp_ns) {
    hal::Frame frame = frame_of(error_class, {0, 0, 0, 0, 0, 0, 0, 0}, stamp_ns);
    frame.error = true;
    return frame;
}

void silence(Frames& frames) { frames.clear(); }

} // namespace

TEST_CASE("error frames are not decoded as data whatever their bits") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    // bus-off, lost arbitration, and classes with the values of our identifiers
    for (const std::uint32_t error_class : {0x040U, 0x002U, 0x111U, 0x3DAU, 0x3DBU, 0x2D0U}) {
        CHECK(arm.tick([&](Frames& frames) {
                     frames.insert(frames.begin() + 1, error_frame(error_class, frames[0].stamp_ns));
                 })
                  .good());
    }
    CHECK(arm.assembly.bus().unknown.count() == 0);
    CHECK(arm.assembly.bus().rejected.count() == 0);
}

TEST_CASE("fault 25: a bus-off controller gives no samples until it restarts") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.bus_state = BusState::off;
    for (int tick = 0; tick < 50; ++tick) {
        const auto off = arm.tick(silence);
        CHECK(off.position() == Reason::bus_off);
        CHECK(off.output() == Reason::bus_off);
        CHECK_FALSE(off.predicted);
    }
    arm.bus.bus_state = BusState::active;
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 2);
    CHECK(arm.run(50));
    CHECK(arm.assembly.counters().positions_refused[static_cast<int>(Reason::bus_off)] == 50);
}

TEST_CASE("fault 25: values that have not expired are not used while the controller is bus-off") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.bus_state = BusState::off;
    CHECK(arm.tick().position() == Reason::bus_off);
}

TEST_CASE("an error-passive controller is reported and its data are learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const BusState state : {BusState::warning, BusState::passive}) {
        arm.bus.bus_state = state;
        CHECK(arm.run(20));
        CHECK(arm.assembly.bus().health.degraded());
    }
    arm.bus.bus_state = BusState::active;
    CHECK(arm.run(1));
    CHECK_FALSE(arm.assembly.bus().health.degraded());
}

TEST_CASE("lost arbitration is not a fault") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int tick = 0; tick < 50; ++tick) {
        arm.bus.condition.lost_arbitrations += 100;
        arm.bus.condition.error_frames += 100;
        CHECK(arm.tick([&](Frames& frames) { frames.push_back(error_frame(0x002, frames[0].stamp_ns)); })
                  .good());
    }
}

TEST_CASE("a full send queue refuses our frames and has no other effect") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.full = true;
    for (int tick = 0; tick < 50; ++tick) {
        CHECK(arm.bus.send(hal::icub::StrainBoard(0x0D).request_full_scale(0)) == hal::SendResult::refused);
        CHECK(arm.tick().good());
    }
    CHECK(arm.bus.condition.send_refused == 50);
}

TEST_CASE("an interface that is down is distinguished from a silent one") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.bus_state = BusState::interface_down;
    for (int tick = 0; tick < 20; ++tick) {
        CHECK(arm.tick(silence).position() == Reason::interface_down);
    }
    arm.bus.bus_state = BusState::active;
    CHECK(arm.tick(silence).position() == Reason::position_stale);
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 2);
    CHECK(arm.run(20));
}
