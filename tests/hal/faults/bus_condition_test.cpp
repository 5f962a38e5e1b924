// SPDX-License-Identifier: Apache-2.0
// Faults of the controller and its interface: what their state and counters mean for the samples. What only a
// socket can show is tested with the sockets: that error frames are asked for (F1) and read in their own size
// (F2), how bus-off, ENOBUFS, dropped frames and a lost interface become state and counters (F3, F6, F7, F9),
// which clock stamps a frame and how the stamp is read (F17, F22), and how the flags of a frame become its
// origin (F19).
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

TEST_CASE("F1: error frames are not taken for data, whatever their bits") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    // bus-off, lost arbitration, and classes that look like our identifiers
    for (const std::uint32_t error_class : {0x040U, 0x002U, 0x111U, 0x3DAU, 0x3DBU, 0x2D0U}) {
        CHECK(arm.tick([&](Frames& frames) {
                     frames.insert(frames.begin() + 1, error_frame(error_class, frames[0].stamp_ns));
                 })
                  .good());
    }
    CHECK(arm.assembly.bus(0).unknown.count() == 0);
    CHECK(arm.assembly.bus(0).rejected.count() == 0);
}

TEST_CASE("F3: on a bus-off controller there is no sample, and all goes on when it restarts") {
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

TEST_CASE("F3: values that are still fresh do not count on a bus-off controller") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.bus_state = BusState::off;
    CHECK(arm.tick().position() == Reason::bus_off);
}

TEST_CASE("F4: an error-passive controller is reported and what it receives is learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const BusState state : {BusState::warning, BusState::passive}) {
        arm.bus.bus_state = state;
        CHECK(arm.run(20));
        CHECK(arm.assembly.bus(0).health.degraded());
    }
    arm.bus.bus_state = BusState::active;
    CHECK(arm.run(1));
    CHECK_FALSE(arm.assembly.bus(0).health.degraded());
}

TEST_CASE("F5: lost arbitration is normal") {
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

TEST_CASE("F6: a full send queue refuses our frames and nothing else") {
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

TEST_CASE("F9: an interface that is down is told apart from one that is silent") {
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
