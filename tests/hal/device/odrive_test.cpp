// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/odrive.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace odrive_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr std::int64_t ms = 1'000'000;

/// Node 3; eight turns of the motor to one of the joint.
OdriveAxis shoulder() {
    return OdriveAxis({.node = 3, .joint = 2, .motor_per_joint = 8, .heartbeat_timeout_ns = 250 * ms});
}

const Frame half_a_turn = frame_of(0x069, {0x00, 0x00, 0x00, 0x3F, 1, 2, 3, 4}, 1000 * ms); // 0.5
const Frame healthy = frame_of(0x061, {0, 0, 0, 0, 8, 0, 0, 0x80}, 900 * ms);
const Frame encoder_error = frame_of(0x061, {0, 0, 0, 0, 8, 0, 1, 0}, 900 * ms);

TEST_CASE("an ODrive's estimate is in turns of the motor") {
    OdriveAxis axis = shoulder();
    CHECK(axis.decode(healthy).reason == Reason::ok);
    const Decoded decoded = axis.decode(half_a_turn);
    REQUIRE(decoded.kind == Kind::values);
    CHECK(decoded.joint[0].joint == 2);
    CHECK(decoded.joint[0].position_reason == Reason::ok);
    CHECK(decoded.joint[0].position_rad == Approx(std::numbers::pi / 8).epsilon(1e-14));
    CHECK_FALSE(decoded.joint[0].raw_zero);
}

TEST_CASE("an ODrive's estimate is good only while the heartbeat says so") {
    OdriveAxis axis = shoulder();
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::heartbeat_missing);
    CHECK(axis.decode(encoder_error).reason == Reason::encoder_fault);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::encoder_fault);
    axis.decode(healthy);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(at_time(half_a_turn, 1150 * ms)).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(at_time(half_a_turn, 1151 * ms)).joint[0].position_reason == Reason::heartbeat_missing);
}

TEST_CASE("what an ODrive sends for an estimate it does not have is a zero, or no number") {
    OdriveAxis axis = shoulder();
    axis.decode(healthy);
    CHECK(axis.decode(frame_of(0x069, {0, 0, 0, 0, 0, 0, 0, 0}, 900 * ms)).joint[0].raw_zero);
    const Frame no_number = frame_of(0x069, {0, 0, 0xC0, 0x7F, 0, 0, 0, 0}, 900 * ms);
    CHECK(axis.decode(no_number).joint[0].position_reason == Reason::position_out_of_range);
}

TEST_CASE("an ODrive's frames have exactly eight bytes") {
    CHECK(rejects_malformed(shoulder(), half_a_turn, {8}));
    CHECK(rejects_malformed(shoulder(), healthy, {8}));
    for (const std::uint32_t id : {0x009U, 0x06AU, 0x049U, 0x041U}) {
        CHECK(shoulder().decode(frame_of(id, {0, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
        CHECK_FALSE(shoulder().claims(id));
    }
}

TEST_CASE("what a simulated ODrive sends decodes to a float's resolution") {
    DFDYN_SEEDED_ENGINE(engine);
    OdriveAxis axis = shoulder();
    axis.decode(axis.encode_heartbeat(false));
    std::uniform_real_distribution<double> angle(-3, 3);
    for (int i = 0; i < 1000; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = angle(engine);
        const Decoded decoded = axis.decode(axis.encode(values).frame[0]);
        REQUIRE(decoded.joint[0].position_reason == Reason::ok);
        REQUIRE(std::abs(decoded.joint[0].position_rad - values[0].position_rad) <= 3 * 6e-8);
    }
    CHECK(axis.decode(axis.encode_heartbeat(true)).reason == Reason::encoder_fault);
}

} // namespace odrive_test
