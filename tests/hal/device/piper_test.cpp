// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/piper.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace piper_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr double degree = 3.14159265358979323846 / 180;

PiperPair pair(int number, PiperPair::Config config = {}) {
    config.pair = number;
    config.joint = {2 * number, 2 * number + 1};
    return PiperPair(config);
}

/// Joints 3 and 4 at 90° and -45°: 90000 and -45000.
Frame angles(std::uint32_t id = 0x2A6) {
    return frame_of(id, {0x00, 0x01, 0x5F, 0x90, 0xFF, 0xFF, 0x50, 0x38}, 5);
}

/// Speed -100, current -1500, position 7 of joint 3.
Frame fast(std::uint32_t id = 0x253) { return frame_of(id, {0xFF, 0x9C, 0xFA, 0x24, 0, 0, 0, 7}); }

/// 24.0 V, 30 °C, 35 °C, status, no supply current, as for all small motors.
Frame slow(std::uint8_t status, std::uint32_t id = 0x263) {
    return frame_of(id, {0x00, 0xF0, 0x00, 30, 35, status, 0, 0});
}

TEST_CASE("a Piper's frame of angles has two joints, big-endian, in thousandths of a degree") {
    const Decoded decoded = pair(1).decode(angles());
    REQUIRE(decoded.kind == Kind::values);
    REQUIRE(decoded.joints == 2);
    CHECK(decoded.joint[0].joint == 2);
    CHECK(decoded.joint[1].joint == 3);
    CHECK(decoded.joint[0].stamp_ns == 5);
    CHECK(decoded.joint[0].position_rad == Approx(90 * degree).epsilon(1e-13));
    CHECK(decoded.joint[1].position_rad == Approx(-45 * degree).epsilon(1e-13));
    CHECK(decoded.joint[0].position_reason == Reason::ok);
    CHECK(decoded.joint[0].effort_reason == Reason::no_output);
    CHECK(decoded.joint[0].step_rad == Approx(0.001 * degree).epsilon(1e-13));
}

TEST_CASE("a Piper's current is signed and its effort is the current times a factor") {
    const Decoded decoded = pair(1).decode(fast());
    REQUIRE(decoded.joints == 1);
    CHECK(decoded.joint[0].joint == 2);
    CHECK(decoded.joint[0].position_reason == Reason::waiting_for_position);
    CHECK(decoded.joint[0].velocity == Approx(-0.1).epsilon(1e-13));
    CHECK(decoded.joint[0].effort == Approx(-1.5).epsilon(1e-13)); // A
    CHECK(decoded.joint[0].effort_reason == Reason::ok);
    PiperPair::Config config;
    config.torque = true;
    CHECK(pair(1, config).decode(fast(0x253)).joint[0].effort == Approx(-1.5 * 1.18125).epsilon(1e-13));
    CHECK(pair(1, config).decode(fast(0x254)).joint[0].effort == Approx(-1.5 * 0.95844).epsilon(1e-13));
    CHECK(pair(1, config).decode(fast(0x254)).joint[0].joint == 3);
}

TEST_CASE("old firmware of a Piper has other units on the same identifiers") {
    PiperPair::Config config;
    config.firmware = PiperFirmware::rpm;
    const JointValue value = pair(1, config).decode(fast()).joint[0];
    CHECK(value.velocity == Approx(-100 * 360 * degree / 60).epsilon(1e-13));
    CHECK(value.effort == Approx(-150).epsilon(1e-13));
}

TEST_CASE("the second Piper on a bus has its own range of identifiers") {
    PiperPair::Config config;
    for (const std::uint32_t first : {0x2A1U, 0x2B1U, 0x2C1U}) {
        config.feedback_id = first;
        for (const std::uint32_t other : {0x2A1U, 0x2B1U, 0x2C1U}) {
            const Kind kind = pair(1, config).decode(angles(other + 5)).kind;
            CHECK((kind == Kind::values) == (first == other));
        }
    }
    CHECK(pair(0).decode(angles(0x2A5)).joint[1].joint == 1);
    CHECK(pair(2).decode(angles(0x2A7)).joint[0].joint == 4);
    CHECK(pair(2).decode(angles(0x2A6)).kind == Kind::nothing);
}

TEST_CASE("a Piper's values are rejected while the drive is not enabled or has a fault") {
    for (unsigned status = 0; status < 256; ++status) {
        PiperPair device = pair(1);
        device.decode(slow(static_cast<std::uint8_t>(status)));
        const bool fault = (status & 0x2F) != 0; // bits 4 and 7 changed their meaning
        const bool enabled = (status & 0x40) != 0;
        const Reason expected = fault     ? Reason::device_fault
                                : enabled ? Reason::ok
                                          : Reason::device_not_operational;
        REQUIRE(device.decode(angles()).joint[0].position_reason == expected);
        REQUIRE(device.decode(angles()).joint[1].position_reason == Reason::ok); // another drive
        REQUIRE(device.decode(fast()).joint[0].effort_reason == expected);
        PiperPair::Config config;
        config.firmware = PiperFirmware::current;
        PiperPair newer = pair(1, config);
        newer.decode(slow(static_cast<std::uint8_t>(status)));
        const bool protection = (status & 0x90) != 0; // collision, stall
        REQUIRE(newer.decode(angles()).joint[0].position_reason ==
                (protection ? Reason::device_fault : expected));
    }
}

TEST_CASE("a joint that does not communicate with its Piper has no values") {
    PiperPair device = pair(1);
    CHECK(device.decode(frame_of(0x2A1, {1, 5, 1, 0, 0, 0, 0, 0x08})).reason ==
          Reason::encoder_fault); // joint 4
    CHECK(device.decode(angles()).joint[0].position_reason == Reason::ok);
    CHECK(device.decode(angles()).joint[1].position_reason == Reason::encoder_fault);
    CHECK(device.decode(frame_of(0x2A1, {1, 0, 1, 0, 0, 0, 0, 0})).reason == Reason::ok);
    CHECK(device.decode(angles()).joint[1].position_reason == Reason::ok);
}

TEST_CASE("a Piper's frames have eight classic bytes") {
    CHECK(rejects_malformed(pair(1), angles(), {8}));
    CHECK(rejects_malformed(pair(1), fast(), {8}));
    CHECK(rejects_malformed(pair(1), slow(0x40), {8}));
    for (std::uint32_t id = 0; id < 0x800; ++id) {
        const bool one = id == 0x2A6 || id == 0x253 || id == 0x254 || id == 0x263 || id == 0x264;
        REQUIRE(pair(1).claims(id) == one);
        const Kind kind = pair(1).decode(angles(id)).kind;
        REQUIRE((kind != Kind::nothing) == (one || id == 0x2A1));
    }
}

TEST_CASE("a Piper's positions at an end of their range are invalid") {
    CHECK(pair(1).decode(frame_of(0x2A6, {0x7F, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0})).joint[0].position_reason ==
          Reason::position_out_of_range);
    CHECK(pair(1).decode(frame_of(0x2A6, {0x7F, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0})).joint[1].raw_zero);
    CHECK(pair(1).decode(frame_of(0x253, {0, 0, 0x80, 0x00, 0, 0, 0, 0})).joint[0].effort_reason ==
          Reason::output_saturated);
}

TEST_CASE("a Piper's angles are converted with the joint's direction and zero") {
    PiperPair::Config config;
    config.sign = {-1, 1};
    config.zero_rad = {0.5, 0};
    const Decoded decoded = pair(1, config).decode(angles());
    CHECK(decoded.joint[0].position_rad == Approx(0.5 - 90 * degree).epsilon(1e-13));
    CHECK(pair(1, config).decode(fast()).joint[0].effort == Approx(1.5).epsilon(1e-13));
    CHECK(pair(1, config).decode(fast()).joint[0].velocity == Approx(0.1).epsilon(1e-13));
}

TEST_CASE("a torque command to a Piper's joint has eight bits and a check sum") {
    const Frame command = pair(1).encode_torque(1, 4);
    CHECK(command.id == 0x15D); // joint 4
    CHECK(command.data[4] == 0);
    CHECK(command.data[3] % 16 == 0); // kp
    const int torque = command.data[6] % 16 * 16 + command.data[7] / 16;
    CHECK(std::abs(torque - 191) <= 1); // 3/4 of 255: +4 of ±8 N·m
    std::uint8_t sum = 0;
    for (std::size_t i = 0; i < 7; ++i) {
        sum = static_cast<std::uint8_t>(sum ^ command.data[i]);
    }
    CHECK(command.data[7] % 16 == sum % 16);
    CHECK(pair(1).decode_torque(1, command).value() == Approx(4).margin(8.01 / 255));
    CHECK_FALSE(pair(1).decode_torque(0, command));
    Frame damaged = command;
    damaged.data[0] ^= 1U;
    CHECK_FALSE(pair(1).decode_torque(1, damaged));
    CHECK(pair(0).command(command) == MotorCommand::control);
    CHECK(pair(0).command(frame_of(0x475, {7, 0xAE, 0, 0, 0, 0, 0, 0})) == MotorCommand::set_zero);
}

TEST_CASE("a simulated Piper's frames are decoded to half a count") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-3, 3);
    PiperPair device = pair(2);
    for (int i = 0; i < 300; ++i) {
        std::array<JointValue, 2> values{};
        for (JointValue& value : values) {
            value.position_rad = uniform(engine);
            value.effort = uniform(engine);
        }
        const FrameList sent = device.encode(values);
        REQUIRE(sent.count == 3);
        const Decoded both = device.decode(sent.frame[0]);
        for (std::size_t k = 0; k < 2; ++k) {
            REQUIRE(std::abs(both.joint[k].position_rad - values[k].position_rad) < 0.501 * 0.001 * degree);
            const JointValue current = device.decode(sent.frame[k + 1]).joint[0];
            REQUIRE(current.joint == both.joint[k].joint);
            REQUIRE(std::abs(current.effort - values[k].effort) < 0.000501);
        }
    }
}

} // namespace piper_test
