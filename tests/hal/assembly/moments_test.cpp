// SPDX-License-Identifier: Apache-2.0
// Triggers: SYNCs and complete sets.
#include "dfdyn/hal/device/cia402.hpp"
#include "tests/hal/support/arm_on_bus.hpp"

namespace moments_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;

using Arm = SampleAssembly<double, 2, Cia402Drive, 2, EffortOutput<2, 8>>;
using Kind = dfdyn::hal::SampleTrigger::Kind;

std::array<Cia402Drive, 2> two_drives() {
    Cia402Drive::Config first{.node = 1, .joint = 0, .effort_pdo = 0x380, .effort_length = 2};
    Cia402Drive::Config second = first;
    second.node = 2;
    second.joint = 1;
    return {Cia402Drive(first), Cia402Drive(second)};
}

Arm make_drives() {
    const TrackConfig track{
        .max_age_ns = 15 * ms, .latency_ns = 0, .qualification = {.readings = 1, .zero_readings = 1}};
    return {{.board = two_drives(),
             .position = track,
             .position_range = {Range{-10, 10}, Range{-10, 10}},
             .clock = {},
             .limits = {MotionLimits{30, 100}, MotionLimits{30, 100}}},
            EffortOutput<2, 8>({.track = track, .range = {Range{-30, 30}, Range{-30, 30}}})};
}

TEST_CASE("at a SYNC, the values measured at the one before are complete and exact") {
    Arm arm = make_drives();
    const std::array<Cia402Drive, 2> drives = two_drives();
    for (int cycle = 0; cycle < 20; ++cycle) {
        const std::int64_t sync_ns = cycle * 10 * ms;
        const dfdyn::hal::SampleTrigger moment =
            arm.take(at_time(Cia402Drive::encode_sync(), sync_ns), sync_ns);
        if (cycle == 0) {
            CHECK(moment.kind == Kind::none);
        } else {
            REQUIRE(moment.kind == Kind::sync);
            CHECK(moment.instant_ns == sync_ns - 10 * ms);
            const auto [sample, report] = arm.assemble(moment.instant_ns, sync_ns);
            REQUIRE(report.position == Reason::ok);
            REQUIRE(sample.output_valid);
            CHECK(sample.time_ns == sync_ns - 10 * ms);
            CHECK(sample.position[0] == Approx(0.1 * (cycle - 1)));
            CHECK(sample.position[1] == Approx(-0.2 * (cycle - 1)));
            CHECK(sample.output[0] == Approx(0.5 * (cycle - 1)));
            CHECK(sample.output[1] == Approx(cycle - 1));
        }
        for (std::size_t i = 0; i < 2; ++i) { // the answers come late and at different times
            std::array<JointValue, 1> value{};
            value[0].position_rad = (i == 0 ? 0.1 : -0.2) * cycle;
            value[0].effort = 0.5 * static_cast<double>(i + 1) * cycle;
            const FrameList answer = drives[i].encode(value);
            for (int f = 0; f < answer.count; ++f) {
                const std::int64_t stamp = sync_ns + (1 + static_cast<int>(i) * 3 + f) * ms;
                arm.take(at_time(answer.frame[static_cast<std::size_t>(f)], stamp), stamp);
            }
        }
    }
    CHECK(arm.bus().unknown.count() == 0); // the SYNC is a known identifier
    CHECK_FALSE(arm.colliding_id().has_value());
}

TEST_CASE("after an incomplete set is dropped, the next one begins with the next frame") {
    SampleTriggerWatch<2> moments{{}};
    CHECK_FALSE(moments.drop_set(0));
    moments.measured(0);
    CHECK(moments.completed(5).kind == SampleTrigger::Kind::none); // joint 2 is lost
    CHECK(moments.drop_set(5));
    CHECK_FALSE(moments.drop_set(5));
    moments.measured(0);
    moments.measured(1);
    CHECK(moments.completed(5).kind == SampleTrigger::Kind::none); // the output belongs to the dropped set
    const SampleTrigger moment = moments.completed(6);
    CHECK(moment.kind == SampleTrigger::Kind::set);
    CHECK(moment.instant_ns == 6);
}

TEST_CASE("an output that arrives after its set was dropped does not complete the next one") {
    SampleTriggerWatch<1> moments{{}};
    moments.measured(0);
    CHECK(moments.completed(10).kind == SampleTrigger::Kind::set);
    moments.measured(0);
    CHECK(moments.drop_set(21));
    moments.measured(0);
    CHECK(moments.completed(20).kind == SampleTrigger::Kind::none); // half of the output was lost
    CHECK(moments.completed(30).instant_ns == 30);
}

TEST_CASE("a drive that does not answer a SYNC has no new value") {
    Arm arm = make_drives();
    const std::array<Cia402Drive, 2> drives = two_drives();
    std::vector<Reason> positions;
    for (int cycle = 0; cycle < 8; ++cycle) {
        const std::int64_t sync_ns = cycle * 10 * ms;
        if (arm.take(at_time(Cia402Drive::encode_sync(), sync_ns), sync_ns).kind == Kind::sync) {
            positions.push_back(arm.assemble(sync_ns - 10 * ms, sync_ns).report.position);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (i == 1 && cycle >= 4) {
                continue; // joint 2 fails
            }
            std::array<JointValue, 1> value{};
            value[0].position_rad = 0.1 * (cycle + 1);
            arm.take(at_time(drives[i].encode(value).frame[0], sync_ns + ms), sync_ns + ms);
        }
    }
    // cycle 4 is held from cycle 3, 10 ms before; then it is stale
    CHECK(positions == std::vector<Reason>{Reason::ok, Reason::ok, Reason::ok, Reason::ok, Reason::ok,
                                           Reason::position_stale, Reason::position_stale});
}

TEST_CASE("a repeated frame of the joints does not complete a set") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    std::array<Frame, 16> buffer{};
    const Frame repeated = arm.frames_of(arm.number - 1).front();
    for (const int expected : {0, 1}) {
        std::vector<Frame> frames = arm.frames_of(arm.number);
        frames.front() = expected == 0 ? repeated : frames.front();
        arm.bus.waiting.insert(arm.bus.waiting.end(), frames.begin(), frames.end());
        arm.bus.now = ArmOnBus::time_ns(arm.number) + 400 * us;
        int sets = 0;
        arm.assembly.drain(arm.bus, buffer, [&](const dfdyn::hal::SampleTrigger&) { ++sets; });
        CHECK(sets == expected);
        ++arm.number;
    }
}

TEST_CASE("a set is complete when all joints and the wrench are new, at the wrench's time") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    std::array<Frame, 16> buffer{};
    for (int tick = 0; tick < 20; ++tick) {
        int sets = 0;
        for (const Frame& frame : arm.frames_of(arm.number)) {
            arm.bus.waiting.push_back(frame);
        }
        arm.bus.now = ArmOnBus::time_ns(arm.number) + 400 * us;
        arm.assembly.drain(arm.bus, buffer, [&](const dfdyn::hal::SampleTrigger& moment) {
            ++sets;
            CHECK(moment.kind == dfdyn::hal::SampleTrigger::Kind::set);
            CHECK(moment.instant_ns == ArmOnBus::time_ns(arm.number) + 200 * us);
            const auto assembled = arm.assembly.assemble(moment.instant_ns, arm.bus.now);
            CHECK(assembled.valid());
            CHECK(assembled.sample.output_valid);
        });
        CHECK(sets == 1);
        ++arm.number;
    }
}

} // namespace moments_test
