// SPDX-License-Identifier: Apache-2.0
// Frames that are lost, late or out of order.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

void without_wrench(Frames& frames) { frames.resize(1); }

auto without(std::size_t index) {
    return [index](Frames& frames) { frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(index)); };
}

} // namespace

TEST_CASE("fault 38: frames dropped by the kernel or the controller invalidate the output of that tick") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (std::uint64_t hal::BusCounters::*counter :
         {&hal::BusCounters::dropped, &hal::BusCounters::controller_overruns}) {
        arm.bus.condition.*counter += 3;
        const auto lossy = arm.tick();
        CHECK(lossy.predicted);
        CHECK(lossy.output() == Reason::frames_lost);
        CHECK(arm.run(20));
    }
    CHECK(arm.assembly.bus().health.losses() == 6);
}

TEST_CASE("fault 38: halves of a wrench on both sides of a loss are not paired even if their time stamps are "
          "close") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const std::uint64_t pairs = arm.assembly.output().pairing().pairs();
    arm.tick([](Frames& frames) {
        without(torque_frame)(frames);
        frames[force_frame].stamp_ns += 700 * us;
    });
    arm.bus.condition.dropped += 2; // the torque, and the force of the next wrench
    const auto lossy = arm.tick([](Frames& frames) {
        without(force_frame)(frames);
        frames[1].stamp_ns -= 200 * us; // the torque, 230 µs after that force
    });
    CHECK_FALSE(lossy.learned);
    CHECK(arm.assembly.output().pairing().pairs() == pairs);
    CHECK(arm.ticks_to_recover() <= 3);
}

TEST_CASE("fault 38: messages that a board lost invalidate the output of that tick") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto lossy =
        arm.tick([](Frames& frames) { frames.push_back(at_time(frame_of(0x115, {0}), frames[0].stamp_ns)); });
    CHECK(lossy.output() == Reason::frames_lost);
    CHECK(lossy.predicted);
    CHECK(arm.run(20));
}

TEST_CASE("fault 3: a silent joint gives no samples and is named") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    int held = 0;
    while (arm.tick(without(joint_frame)).position() == Reason::ok) {
        ++held;
    }
    CHECK(held == 2); // up to 1.9 ms after the last position; the limit is 2.5 ms
    for (int tick = 0; tick < 100; ++tick) {
        const auto silent = arm.tick(without(joint_frame));
        CHECK(silent.position() == Reason::position_stale);
        CHECK(silent.assembled.report.joint == 0);
        CHECK(silent.assembled.report.position_age_ns[0] == (tick + 5) * ms - 100 * us);
    }
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 2);
    CHECK(arm.run(50));
}

TEST_CASE("fault 4: without its sensor the arm is predicted but not learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    CHECK(arm.tick(without_wrench).output() == Reason::output_not_new);
    CHECK(arm.tick(without_wrench).output() == Reason::output_not_new);
    for (int tick = 0; tick < 100; ++tick) {
        const auto silent = arm.tick(without_wrench);
        CHECK(silent.predicted);
        CHECK(silent.output() == Reason::output_stale);
    }
    CHECK(arm.assembly.output().track().staleness().count() >= 100);
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + 2);
    CHECK(arm.run(50));
    CHECK(arm.assembly.output().track().gap().count() == 1);
}

TEST_CASE("each measurement is delivered as new exactly once") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const std::uint64_t before = arm.estimator.counters().learned;
    for (int tick = 0; tick < 300; ++tick) { // a sensor at half the rate of the joints
        const auto every_other = tick % 2 == 0 ? arm.tick() : arm.tick(without_wrench);
        CHECK(every_other.predicted);
    }
    CHECK(arm.estimator.counters().learned - before <= 150);
    CHECK(arm.estimator.counters().learned - before >= 148);
}

TEST_CASE("a wrench that lost a half is not learned and the next one is") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const std::size_t half : {force_frame, torque_frame}) {
        const auto first = arm.tick(without(half));
        CHECK(first.predicted);
        CHECK_FALSE(first.learned);
        CHECK(arm.ticks_to_recover() <= 2);
        CHECK(arm.run(10));
    }
    const hal::PairGate& pairing = arm.assembly.output().pairing();
    CHECK(pairing.unpaired(0) == 1);
    CHECK(pairing.unpaired(1) == 1);
}

TEST_CASE("a sensor that loses all its torque frames is never learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.tick(without(torque_frame));
    for (int tick = 0; tick < 100; ++tick) {
        const auto halved = arm.tick(without(torque_frame));
        CHECK(halved.predicted);
        CHECK(halved.output() == Reason::output_incomplete);
    }
    CHECK(arm.ticks_to_recover() <= 3);
}

TEST_CASE("fault 28: a burst above the limit of a tick is counted and read in the next ticks") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const std::uint64_t bounded = arm.bus.condition.saturated_drains;
    arm.tick([](Frames& frames) {
        const Frames wanted = frames;
        // 8 drains of 64 frames are 512
        frames.assign(600, at_time(frame_of(0x7F0, {1}), wanted[0].stamp_ns));
        frames.insert(frames.end(), wanted.begin(), wanted.end());
    });
    CHECK(arm.bus.waiting.size() == 600 + 3 - 512);
    CHECK(arm.bus.condition.saturated_drains - bounded == 8);
    CHECK(arm.tick().predicted);
    CHECK(arm.bus.waiting.empty());
    CHECK(arm.ticks_to_recover() <= 2);
    CHECK(arm.assembly.bus().unknown.count() == 600);
}

TEST_CASE("halves without their own time stamps are paired in their order") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.clock_error_ns = ms; // frames are stamped when they are read
    for (int tick = 0; tick < 50; ++tick) {
        CHECK(arm.tick([&](Frames& frames) {
                     for (hal::Frame& frame : frames) {
                         frame.stamp_ns = ArmOnBus::time_ns(arm.number + 1);
                         frame.stamp_source = hal::StampSource::arrival;
                     }
                 })
                  .predicted);
    }
    CHECK(arm.assembly.output().pairing().unpaired(0) + arm.assembly.output().pairing().unpaired(1) == 0);
}

TEST_CASE("fault 7: frames that overtook each other are ordered by their time stamps") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int tick = 0; tick < 50; ++tick) {
        CHECK(arm.tick([](Frames& frames) { std::ranges::reverse(frames); }).good());
    }
}

TEST_CASE("fault 7: positions that were overtaken by newer ones are rejected and counted") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    hal::Frame late;
    arm.tick([&](Frames& frames) {
        late = frames[joint_frame];
        without(joint_frame)(frames);
    });
    CHECK(arm.tick([&](Frames& frames) { frames.push_back(late); }).predicted);
    CHECK(arm.assembly.position(0).not_later() == 1);
    CHECK(arm.run(20));
}

TEST_CASE("fault 28: all waiting frames are read in a tick so that none becomes old in the queue") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int burst = 0; burst < 10; ++burst) {
        Frames frames;
        for (int k = 0; k < 10; ++k) { // the reader paused for 10 ms
            for (const hal::Frame& frame : arm.frames_of(arm.number)) {
                arm.bus.waiting.push_back(frame);
            }
            ++arm.number;
        }
        const auto tick = arm.read();
        CHECK(arm.bus.waiting.empty());
        CHECK(tick.position() == Reason::ok);
        CHECK(tick.assembled.report.position_age_ns[0] == 900 * us);
        CHECK(tick.assembled.report.output_age_ns == 800 * us);
    }
}
