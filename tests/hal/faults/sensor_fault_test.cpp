// SPDX-License-Identifier: Apache-2.0
// Wrong wrenches that look like valid ones.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

/// The wrench of earlier frames with new time stamps.
auto with_wrench_of(const Frames& earlier) {
    return [&earlier](Frames& frames) {
        for (const std::size_t half : {force_frame, torque_frame}) {
            frames[half] = at_time(earlier[half], frames[half].stamp_ns);
        }
    };
}

/// Replaces the wrench by that of a sensor that has just started: all zeros.
void send_zero_wrench(Frames& frames) {
    for (const std::size_t half : {force_frame, torque_frame}) {
        frames[half] = at_time(frame_of(frames[half].id, {0, 0x80, 0, 0x80, 0, 0x80}), frames[half].stamp_ns);
    }
}

} // namespace

TEST_CASE("fault 14: repeated sensor values with new time stamps are not learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const Frames stuck = arm.frames_of(arm.number - 1);
    // The first repetitions could be a coincidence, so their samples are not checked. The samples are checked
    // from the limit on.
    for (int tick = 1; tick < ArmOnBus::frozen_limit; ++tick) {
        arm.bus.waiting.clear();
        ++arm.number;
        for (hal::Frame frame : arm.frames_of(arm.number - 1)) {
            const std::size_t half = frame.id == stuck[force_frame].id ? force_frame : torque_frame;
            arm.bus.waiting.push_back(
                frame.id == stuck[joint_frame].id ? frame : at_time(stuck[half], frame.stamp_ns));
        }
        arm.bus.now = ArmOnBus::time_ns(arm.number);
        std::array<hal::Frame, 8> buffer{};
        arm.assembly.drain(arm.bus, buffer);
    }
    for (int tick = 0; tick < 100; ++tick) {
        const auto frozen = arm.tick(with_wrench_of(stuck));
        CHECK(frozen.output() == Reason::output_frozen);
        CHECK(frozen.position() == Reason::ok);
        CHECK(frozen.predicted == (tick >= ArmOnBus::lags));
    }
    CHECK(arm.assembly.output().frozen().count() == 1);
    CHECK(arm.ticks_to_recover() <= 3);
    CHECK(arm.run(20));
}

TEST_CASE("fault 12: repeated positions of a slow joint are accepted") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    // A motion of 300 µrad per tick is less than a step of the encoder, so positions repeat.
    int repeated = 0;
    hal::Frame last;
    for (int tick = 0; tick < 200; ++tick) {
        CHECK(arm.tick([&](Frames& frames) {
                     repeated += frames[joint_frame].data == last.data ? 1 : 0;
                     last = frames[joint_frame];
                 })
                  .good());
    }
    CHECK(repeated > 10);
}

TEST_CASE("fault 16: the last good wrench repeated by a saturated sensor is not learned") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const Frames last_good = arm.frames_of(arm.number);
    for (const int length : {2, 1, 30}) { // number of saturated ticks
        for (int tick = 0; tick < length; ++tick) {
            const auto saturated = arm.tick([&](Frames& frames) {
                with_wrench_of(last_good)(frames);
                for (const std::size_t half : {force_frame, torque_frame}) {
                    frames[half].length = 7;
                    frames[half].data[6] = 0x05;
                }
            });
            CHECK(saturated.predicted);
            CHECK(saturated.output() == Reason::output_saturated);
        }
        CHECK(arm.ticks_to_recover() <= 3); // three wrenches must agree after the interruption
        CHECK(arm.run(10));
    }
    CHECK(arm.assembly.output().saturation().count() == 33);
    CHECK(arm.assembly.output().saturation().episodes() == 3);
}

TEST_CASE("fault 33: without its full scales the sensor is not learned and positions are predicted") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine, false);
    for (int tick = 0; tick < 50; ++tick) {
        const auto unknown = arm.tick();
        CHECK_FALSE(unknown.learned);
        if (tick > ArmOnBus::qualification_ticks + ArmOnBus::lags) {
            CHECK(unknown.predicted);
            CHECK(unknown.output() == Reason::waiting_for_full_scale);
        }
    }
    arm.answer_full_scales();
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + 2);
    CHECK(arm.run(20));
}

TEST_CASE("fault 33: an impossible full scale stops the learning until all full scales are reported again") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    // 0; 32767, the default; 1500 with its bytes swapped
    for (const auto& [high, low] :
         {std::pair<std::uint8_t, std::uint8_t>{0, 0}, {0x7F, 0xFF}, {0xDC, 0x05}}) {
        arm.bus.waiting.push_back(frame_of(0x2D0, {0x18, 0, high, low}, arm.bus.now));
        for (int tick = 0; tick < 20; ++tick) {
            const auto wrong = arm.tick();
            CHECK(wrong.predicted);
            CHECK(wrong.output() == Reason::full_scale_implausible);
        }
        arm.bus.waiting.push_back(frame_of(0x2D0, {0x18, 0, 0x05, 0xDC}, arm.bus.now));
        arm.tick();
        CHECK(arm.tick().output() == Reason::full_scale_contradicted);
        arm.answer_full_scales();
        CHECK(arm.ticks_to_recover() <= 3);
        CHECK(arm.run(10));
    }
}

TEST_CASE(
    "faults 33 and 34: a changed full scale never rescales the wrench and another set changes nothing") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    arm.bus.waiting.push_back(frame_of(0x2D0, {0x18, 0x20, 0x01, 0xF4}, arm.bus.now)); // set 2: 500 N
    CHECK(arm.run(20));
    arm.bus.waiting.push_back(frame_of(0x2D0, {0x18, 0x00, 0x01, 0xF4}, arm.bus.now)); // the set in use
    for (int tick = 0; tick < 20; ++tick) {
        CHECK(arm.tick().output() == Reason::full_scale_contradicted);
    }
    arm.answer_full_scales();
    CHECK(arm.ticks_to_recover() <= 3);
    CHECK(arm.run(10));
}

TEST_CASE("fault 16: wrenches beyond the sensor's range are rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    // A plausible full scale of another sensor, 9000 N instead of 1500 N, so that large forces exceed 1500 N.
    ArmOnBus arm(engine, false);
    arm.answer_full_scales();
    arm.bus.waiting[0] = frame_of(0x2D0, {0x18, 0, 0x23, 0x28}, arm.bus.waiting[0].stamp_ns);
    const auto overload = [](Frames& frames) {
        frames[force_frame].data[0] = 0;
        frames[force_frame].data[1] = 0xF0; // 0.875 of the full scale
    };
    for (int tick = 0; tick < 30; ++tick) {
        arm.tick(overload);
    }
    const auto beyond = arm.tick(overload);
    CHECK(beyond.predicted);
    CHECK_FALSE(beyond.learned);
    CHECK(beyond.output() == Reason::output_out_of_range);
    CHECK(arm.assembly.output().track().range().count() > 20);
}

TEST_CASE("fault 9: zeros after power-on are not accepted as positions") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    for (int tick = 0; tick < 100; ++tick) {
        const auto zeros = arm.tick([](Frames& frames) { frames[joint_frame].data = {}; });
        CHECK_FALSE(zeros.assembled.valid());
        CHECK_FALSE(zeros.predicted);
    }
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 1);
    CHECK(arm.run(50));
}

TEST_CASE("fault 10: a board qualifies again after a restart") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int tick = 0; tick < 10; ++tick) {
        arm.tick([](Frames& frames) { frames.erase(frames.begin()); });
    }
    for (int tick = 0; tick < 50; ++tick) {
        CHECK_FALSE(arm.tick([](Frames& frames) { frames[joint_frame].data = {}; }).assembled.valid());
    }
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + ArmOnBus::lags + 1);
    CHECK(arm.assembly.position(0).gap().count() >= 1);
}

TEST_CASE("fault 9: zeros of a sensor after power-on are not accepted as a wrench") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    for (int tick = 0; tick < 100; ++tick) {
        CHECK_FALSE(arm.tick(send_zero_wrench).learned);
    }
    CHECK(arm.ticks_to_recover() <= ArmOnBus::qualification_ticks + 1);
}

TEST_CASE("fault 9: after a single wrench of zeros a sensor in use qualifies again") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto zero = arm.tick(send_zero_wrench);
    CHECK(zero.predicted);
    CHECK_FALSE(zero.learned);
    CHECK(zero.output() == Reason::qualifying);
    const int ticks = arm.ticks_to_recover();
    CHECK(ticks >= ArmOnBus::qualification_ticks - 1);
    CHECK(ticks <= ArmOnBus::qualification_ticks + 1);
    CHECK(arm.run(10));
}
