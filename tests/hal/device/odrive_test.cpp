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

/// Node 3, with eight motor turns per joint turn.
OdriveAxis shoulder() {
    return OdriveAxis({.node = 3, .joint = 2, .motor_per_joint = 8, .heartbeat_timeout_ns = 250 * ms});
}

const Frame half_a_turn = frame_of(0x069, {0x00, 0x00, 0x00, 0x3F, 1, 2, 3, 4}, 1000 * ms); // 0.5
const Frame healthy = frame_of(0x061, {0, 0, 0, 0, 8, 0, 0, 0x80}, 900 * ms);
/// ENCODER_FAILED in the error word and the encoder's flag, as sent by firmware 0.5.
const Frame encoder_error = frame_of(0x061, {0, 1, 0, 0, 1, 0, 1, 0}, 900 * ms);
/// Byte 6 is Trajectory_Done in firmware 0.6. In 0.5 it is the encoder's flag, which never comes without an
/// error word.
const Frame byte_six = frame_of(0x061, {0, 0, 0, 0, 8, 0, 1, 0}, 900 * ms);
const Frame no_estimate = frame_of(0x069, {0, 0, 0, 0, 0, 0, 0, 0}, 1000 * ms);

Reason with(OdriveFirmware firmware, const Frame& heartbeat) {
    OdriveAxis axis({.node = 3, .firmware = firmware});
    axis.decode(heartbeat);
    return axis.decode(half_a_turn).joint[0].position_reason;
}

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

TEST_CASE("an ODrive's estimate is valid only while the heartbeat reports no error") {
    OdriveAxis axis = shoulder();
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::heartbeat_missing);
    CHECK(axis.decode(encoder_error).reason == Reason::encoder_fault);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::encoder_fault);
    axis.decode(healthy);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(at_time(half_a_turn, 1150 * ms)).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(at_time(half_a_turn, 1151 * ms)).joint[0].position_reason == Reason::heartbeat_missing);
}

TEST_CASE("a finished trajectory of firmware 0.6 is not a fault without configuring the ODrive's version") {
    CHECK(with(OdriveFirmware::any, byte_six) == Reason::ok);
    CHECK(with(OdriveFirmware::v0_6, byte_six) == Reason::ok);
    CHECK(with(OdriveFirmware::v0_5, byte_six) == Reason::encoder_fault);
}

TEST_CASE("an ODrive's estimates are rejected while any bit of its error word is set in every firmware") {
    for (const OdriveFirmware firmware : {OdriveFirmware::any, OdriveFirmware::v0_5, OdriveFirmware::v0_6}) {
        for (int bit = 0; bit < 32; ++bit) {
            Frame heartbeat = healthy;
            heartbeat.data[static_cast<std::size_t>(bit / 8)] = static_cast<std::uint8_t>(1U << bit % 8);
            CAPTURE(bit);
            CHECK(is_fault(with(firmware, heartbeat)));
        }
        CHECK(with(firmware, healthy) == Reason::ok);
    }
    const Frame missing_estimate = frame_of(0x061, {8, 0, 0, 0, 1, 0, 0, 0}, 900 * ms);
    const Frame motor_failed = frame_of(0x061, {0x40, 0, 0, 0, 1, 1, 0, 0}, 900 * ms);
    CHECK(with(OdriveFirmware::any, missing_estimate) == Reason::encoder_fault);
    CHECK(with(OdriveFirmware::v0_6, missing_estimate) == Reason::encoder_fault);
    CHECK(with(OdriveFirmware::any, motor_failed) == Reason::device_fault);
    CHECK(with(OdriveFirmware::v0_6, encoder_error) ==
          Reason::device_fault); // 0x100 is an over-voltage in that version
}

TEST_CASE("an ODrive's 0.0 after another estimate is rejected before the heartbeat reports the loss") {
    OdriveAxis axis = shoulder();
    axis.decode(healthy);
    // at the start: the position must qualify
    CHECK(axis.decode(no_estimate).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::ok);
    CHECK(axis.decode(no_estimate).joint[0].position_reason == Reason::encoder_fault);
    CHECK(axis.decode(no_estimate).joint[0].raw_zero);
    CHECK(axis.decode(half_a_turn).joint[0].position_reason == Reason::ok);
}

TEST_CASE("a request for an ODrive's estimate is ignored") {
    Frame request = half_a_turn;
    request.remote = true;
    CHECK(shoulder().decode(request).kind == Kind::nothing);
}

TEST_CASE("a missing estimate of an ODrive is zero or not a number") {
    OdriveAxis axis = shoulder();
    axis.decode(healthy);
    CHECK(axis.decode(frame_of(0x069, {0, 0, 0, 0, 0, 0, 0, 0}, 900 * ms)).joint[0].raw_zero);
    const Frame no_number = frame_of(0x069, {0, 0, 0xC0, 0x7F, 0, 0, 0, 0}, 900 * ms);
    CHECK(axis.decode(no_number).joint[0].position_reason == Reason::position_out_of_range);
}

TEST_CASE("an ODrive's frames have exactly eight bytes") {
    CHECK(rejects_malformed(shoulder(), half_a_turn, {8}, Kind::nothing));
    CHECK(rejects_malformed(shoulder(), healthy, {8}, Kind::nothing));
    for (const std::uint32_t id : {0x009U, 0x06AU, 0x049U, 0x041U}) {
        CHECK(shoulder().decode(frame_of(id, {0, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
        CHECK_FALSE(shoulder().claims(id));
    }
}

TEST_CASE("a simulated ODrive's estimates are decoded to a float's resolution") {
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
