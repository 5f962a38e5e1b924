// SPDX-License-Identifier: Apache-2.0
// Unexpected frames: echoes, collisions, wrong lengths.
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

} // namespace

TEST_CASE("fault 29: frames with a wrong type or length are rejected and named") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    std::uint64_t rejected = 0;
    for (const int length : {0, 4, 7}) {
        const auto wrong =
            arm.tick([&](Frames& frames) { frames[joint_frame].length = static_cast<std::uint8_t>(length); });
        CHECK(wrong.predicted); // the last position is held
        CHECK(arm.assembly.bus().rejected.count() == ++rejected);
        CHECK(arm.run(10));
    }
    CHECK(arm.assembly.bus().rejected.first().id == 0x111);
    CHECK(arm.assembly.bus().rejected.first().length == 0);
    CHECK(arm.assembly.bus().rejected.first().reason == Reason::wrong_length);
    const auto padded = arm.tick([](Frames& frames) { frames[force_frame].length = 8; });
    CHECK_FALSE(padded.learned);
    CHECK(arm.ticks_to_recover() <= 2);
    const auto flexible = arm.tick([](Frames& frames) { frames[torque_frame].fd = true; });
    CHECK_FALSE(flexible.learned);
    CHECK(arm.ticks_to_recover() <= 2);
    CHECK(arm.assembly.bus().rejected.count() == 5);
}

TEST_CASE("our own frames that come back are not decoded as the devices' frames") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int tick = 0; tick < 20; ++tick) {
        CHECK(arm.tick([](Frames& frames) {
                     hal::Frame echo = frames[joint_frame];
                     echo.origin = hal::Origin::this_socket;
                     echo.data[0] ^= 0xFF;
                     echo.stamp_ns -= 10 * us;
                     frames.insert(frames.begin(), echo);
                 })
                  .good());
    }
    CHECK(arm.assembly.bus().own == 20);
}

TEST_CASE("frames of this host such as a simulation or a replay on a live bus are counted") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (int tick = 0; tick < 20; ++tick) {
        CHECK(arm.tick([](Frames& frames) { frames[joint_frame].origin = hal::Origin::this_host; }).good());
    }
    CHECK(arm.assembly.bus().from_host == 20);
}

TEST_CASE("fault 30: unknown identifiers are counted and the first one is named") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    CHECK(arm.tick([](Frames& frames) {
                 hal::Frame stranger = frame_of(0x111, {1, 2, 3, 4, 5, 6, 7, 8}, frames[0].stamp_ns);
                 stranger.extended = true; // the same number, but a 29-bit identifier
                 frames.push_back(stranger);
                 frames.push_back(frame_of(0x3CA, {1, 2, 3, 4, 5, 6}, frames[0].stamp_ns));
             })
              .good());
    CHECK(arm.assembly.bus().unknown.count() == 2);
    CHECK(arm.assembly.bus().unknown.first().id == 0x111);
    CHECK(arm.assembly.bus().unknown.first().extended);
}

TEST_CASE("fault 18: a second sensor on the same identifiers is detected and neither is learned") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t behind : {60 * us, 300 * us, 500 * us}) {
        ArmOnBus arm(engine);
        arm.warm_up();
        const auto second_sender = [&](Frames& frames) {
            for (const std::size_t half : {force_frame, torque_frame}) {
                hal::Frame other = frames[half];
                other.data[1] ^= 0x10;
                other.stamp_ns += behind;
                frames.push_back(other);
            }
            std::ranges::sort(frames, {}, &hal::Frame::stamp_ns);
        };
        arm.tick(second_sender);
        for (int tick = 0; tick < 50; ++tick) {
            const auto mixed = arm.tick(second_sender);
            CHECK(mixed.predicted);
            CHECK(mixed.output() == Reason::id_collision);
        }
        CHECK(arm.assembly.output().pairing().doubles() >= 100);
        CHECK(arm.ticks_to_recover() <= 5); // the last collision, and three consistent wrenches
    }
}

TEST_CASE("fault 17: two devices configured for one identifier are detected before the start") {
    using Board = hal::icub::TwoJointBoard;
    using Assembly = hal::SampleAssembly<double, 4, Board, 2, hal::EffortOutput<4, 4>>;
    const auto colliding = [](int second_address) {
        const Assembly::Config config{.board = {Board(1, {0}, {1}), Board(second_address, {2}, {3})},
                                      .position = {.max_age_ns = ms, .latency_ns = 0, .qualification = {}},
                                      .position_range = {},
                                      .clock = {}};
        return Assembly(config, hal::EffortOutput<4, 4>({.track = config.position, .range = {}}))
            .colliding_id();
    };
    CHECK_FALSE(colliding(2).has_value());
    CHECK(colliding(1) == 0x111U);
}
