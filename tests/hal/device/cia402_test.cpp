// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/cia402.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace cia402_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr std::int64_t ms = 1'000'000;

/// Node 5, TPDO2 with position and velocity; 0.001 rad per unit, zero at 0.25 rad; torque in a TPDO4 of 2
/// bytes.
Cia402Drive::Config elbow_config() {
    return {.node = 5,
            .joint = 3,
            .position_pdo = 0x280,
            .position_length = 8,
            .position = {.length = 32, .encoding = Encoding::signed_integer, .factor = 0.001, .offset = 0.25},
            .effort_pdo = 0x480,
            .effort_length = 2,
            .effort = {.length = 16, .encoding = Encoding::signed_integer, .factor = 0.02}};
}

const Frame minus_two = frame_of(0x285, {0x30, 0xF8, 0xFF, 0xFF, 0x11, 0x22, 0x33, 0x44}, 7 * ms); // -2000

TEST_CASE("a CiA 402 drive's PDOs are decoded by their mapping") {
    Cia402Drive drive(elbow_config());
    const Decoded decoded = drive.decode(minus_two);
    REQUIRE(decoded.kind == Kind::values);
    CHECK(decoded.joint[0].joint == 3);
    CHECK(decoded.joint[0].stamp_ns == 7 * ms);
    CHECK(decoded.joint[0].position_reason == Reason::ok);
    CHECK(decoded.joint[0].position_rad == Approx(-1.75));
    CHECK(decoded.joint[0].effort_reason == Reason::no_output);
    const Decoded torque = drive.decode(frame_of(0x485, {0x9C, 0xFF})); // -100
    CHECK(torque.joint[0].position_reason == Reason::waiting_for_position);
    CHECK(torque.joint[0].effort_reason == Reason::ok);
    CHECK(torque.joint[0].effort == Approx(-2));
}

TEST_CASE("values of a synchronous drive were measured at the preceding SYNC") {
    Cia402Drive drive(elbow_config());
    const auto answer = [&](std::int64_t stamp_ns) {
        Frame frame = minus_two;
        frame.stamp_ns = stamp_ns;
        frame.data[0] = static_cast<std::uint8_t>(stamp_ns / ms); // a copy would be no evidence
        return drive.decode(frame).joint[0];
    };
    CHECK(drive.decode(frame_of(0x080, {}, 5 * ms)).kind == Kind::sync);
    CHECK(answer(5 * ms + ms / 4).stamp_ns == 5 * ms);
    CHECK(drive.decode(frame_of(0x080, {0x17}, 6 * ms)).kind == Kind::sync); // with a counter
    CHECK(answer(6 * ms + ms / 4).stamp_ns == 6 * ms);
    const JointValue late = answer(7 * ms + ms / 4); // the answer to the SYNC of 7 ms, which was lost
    CHECK(late.position_reason == Reason::sync_unknown);
    CHECK(late.stamp_ns == 7 * ms + ms / 4);
    Cia402Drive::Config config = elbow_config();
    config.synchronous = false;
    Cia402Drive free_running(config);
    free_running.decode(frame_of(0x080, {}, 5 * ms));
    CHECK(free_running.decode(minus_two).joint[0].stamp_ns == 7 * ms);
}

TEST_CASE("a drive that is not operational has no values") {
    Cia402Drive drive(elbow_config());
    for (const std::uint8_t state : {std::uint8_t{4}, std::uint8_t{127}}) { // stopped, pre-operational
        CHECK(drive.decode(frame_of(0x705, {state})).reason == Reason::device_not_operational);
        CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::device_not_operational);
        CHECK(drive.decode(frame_of(0x485, {0, 0})).joint[0].effort_reason == Reason::device_not_operational);
        CHECK(drive.decode(frame_of(0x705, {5})).reason == Reason::ok);
        CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    }
}

TEST_CASE("a drive without heartbeat is operational from its first PDO after a boot-up") {
    Cia402Drive drive(elbow_config());
    CHECK(drive.decode(frame_of(0x705, {0})).reason == Reason::device_not_operational);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    const Frame torque = frame_of(0x485, {1, 0}, 7 * ms);
    CHECK(drive.decode(torque).joint[0].effort_reason == Reason::ok);
    // in the middle: its zero may have changed, so it must qualify again
    CHECK(drive.decode(frame_of(0x705, {0})).reason == Reason::device_restarted);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::device_restarted);
    CHECK(drive.decode(torque).joint[0].effort_reason == Reason::device_restarted);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    CHECK(drive.decode(torque).joint[0].effort_reason == Reason::ok);
}

TEST_CASE("a drive with heartbeat is operational from the first operational heartbeat after a boot-up") {
    Cia402Drive::Config config = elbow_config();
    config.heartbeat_timeout_ns = 100 * ms;
    Cia402Drive drive(config);
    drive.decode(frame_of(0x705, {0}));
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::device_not_operational);
    drive.decode(frame_of(0x705, {5}));
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
}

TEST_CASE("a reported state expires if no heartbeat is expected") {
    Cia402Drive drive(elbow_config());
    drive.decode(frame_of(0x705, {127}));
    CHECK(drive.decode(at_time(minus_two, 2'900 * ms)).joint[0].position_reason ==
          Reason::device_not_operational);
    CHECK(drive.decode(at_time(minus_two, 3'100 * ms)).joint[0].position_reason == Reason::ok);
}

TEST_CASE("a restart of a drive clears its emergency") {
    Cia402Drive drive(elbow_config());
    drive.decode(frame_of(0x085, {0x05, 0x73, 0, 0, 0, 0, 0, 0}));
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::encoder_fault);
    drive.decode(frame_of(0x705, {0}));
    drive.decode(minus_two);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
}

TEST_CASE("values of a drive with an expected heartbeat are valid only while it arrives") {
    Cia402Drive::Config config = elbow_config();
    config.heartbeat_timeout_ns = 3 * ms;
    Cia402Drive drive(config);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::heartbeat_missing);
    drive.decode(frame_of(0x705, {5}, 4 * ms));
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    CHECK(drive.decode(at_time(minus_two, 7 * ms + 1)).joint[0].position_reason == Reason::heartbeat_missing);
}

TEST_CASE("an emergency rejects the values that it affects until it is cleared") {
    Cia402Drive drive(elbow_config());
    const Frame torque = frame_of(0x485, {1, 0});
    // heartbeat error 0x8130, from a trace in an issue of ros_canopen: not a sensor error
    CHECK(drive.decode(frame_of(0x085, {0x30, 0x81, 0x11, 0, 0, 0, 0, 0})).reason == Reason::device_fault);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    CHECK(drive.decode(torque).joint[0].effort_reason == Reason::device_fault);
    CHECK(drive.decode(frame_of(0x085, {0x05, 0x73, 0, 0, 0, 0, 0, 0})).reason == Reason::encoder_fault);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::encoder_fault);
    // a second emergency does not end the first
    drive.decode(frame_of(0x085, {0x30, 0x81, 0, 0, 0, 0, 0, 0}));
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::encoder_fault);
    CHECK(drive.decode(frame_of(0x085, {0, 0, 0, 0, 0, 0, 0, 0})).reason == Reason::ok);
    CHECK(drive.decode(minus_two).joint[0].position_reason == Reason::ok);
    CHECK(drive.decode(torque).joint[0].effort_reason == Reason::ok);
}

TEST_CASE("a drive's frames have fixed lengths") {
    const Cia402Drive drive(elbow_config());
    CHECK(rejects_malformed(drive, minus_two, {8}));
    CHECK(rejects_malformed(drive, frame_of(0x485, {1, 2}), {2}));
    CHECK(rejects_malformed(drive, frame_of(0x705, {5}), {1}, Kind::nothing)); // a node guarding request
    CHECK(rejects_malformed(drive, frame_of(0x085, {0, 0, 0, 0, 0, 0, 0, 0}), {8}));
    CHECK(rejects_malformed(drive, frame_of(0x080, {}), {0, 1}));
    for (const std::uint32_t id : {0x284U, 0x185U, 0x084U, 0x704U, 0x385U}) {
        CHECK(Cia402Drive(drive).decode(frame_of(id, {0, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
    }
}

TEST_CASE("impossible mappings are rejected before the start") {
    CHECK(Cia402Drive(elbow_config()).config_is_valid());
    const auto invalid = [](auto change) {
        Cia402Drive::Config config = elbow_config();
        change(config);
        return !Cia402Drive(config).config_is_valid();
    };
    CHECK(invalid([](auto& config) { config.node = 0; }));
    CHECK(invalid([](auto& config) { config.node = 128; }));
    CHECK(invalid([](auto& config) { config.position.start_bit = 33; })); // exceeds the PDO
    CHECK(invalid([](auto& config) { config.position.factor = 0; }));
    CHECK(invalid([](auto& config) { config.position_pdo = 0x100; })); // 0x105: reserved
    CHECK(invalid([](auto& config) { config.position_pdo = 0x580; })); // SDO
    CHECK(invalid([](auto& config) { config.effort_length = 1; }));
    CHECK(invalid([](auto& config) { config.effort_pdo = 0x600; }));
    // with two different lengths
    CHECK(invalid([](auto& config) { config.effort_pdo = config.position_pdo; }));
}

TEST_CASE("a simulated drive's values are decoded to within half a unit with one or two PDOs") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> angle(-3, 3);
    for (const bool shared : {false, true}) {
        Cia402Drive::Config config = elbow_config();
        if (shared) {
            config.effort_pdo = config.position_pdo;
            config.effort_length = config.position_length;
            config.effort.start_bit = 32;
        }
        Cia402Drive drive(config);
        for (int i = 0; i < 500; ++i) {
            std::array<JointValue, 1> values{};
            values[0].position_rad = angle(engine);
            values[0].effort = 10 * angle(engine);
            const FrameList sent = drive.encode(values);
            REQUIRE(sent.count == (shared ? 1 : 2));
            const Decoded position = drive.decode(sent.frame[0]);
            const Decoded effort = drive.decode(sent.frame[shared ? 0 : 1]);
            REQUIRE(std::abs(position.joint[0].position_rad - values[0].position_rad) <= 0.50001e-3);
            REQUIRE(std::abs(effort.joint[0].effort - values[0].effort) <= 0.010001);
        }
    }
    Cia402Drive drive(elbow_config());
    CHECK(drive.decode(Cia402Drive::encode_sync()).kind == Kind::sync);
    CHECK(drive.decode(drive.encode_heartbeat(Cia402Drive::State::stopped)).reason ==
          Reason::device_not_operational);
    CHECK(drive.decode(drive.encode_emcy(0x7300)).reason == Reason::encoder_fault);
}

} // namespace cia402_test
