// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/cubemars.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace cubemars_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr double degree = 3.14159265358979323846 / 180;

/// An AK80-9 in MIT mode as motor 2, which answers on identifier 0.
CubemarsMitMotor mit_motor() {
    return CubemarsMitMotor({.motor_id = 2,
                             .feedback_id = 0,
                             .joint = 1,
                             .position_max = 12.5,
                             .velocity_max = 50,
                             .torque_max = 18,
                             .shared_feedback_id = true});
}

TEST_CASE("a CubeMars motor in MIT mode has a temperature and an error after the common bytes") {
    const Frame frame = frame_of(0x000, {2, 0x9C, 0x40, 0xA1, 0x2B, 0xCD, 31, 0});
    const JointValue value = mit_motor().decode(frame).joint[0];
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.joint == 1);
    CHECK(value.position_rad == Approx(40000 / 65535.0 * 25 - 12.5).epsilon(1e-13));
    CHECK(value.velocity == Approx(0xA12 / 4095.0 * 100 - 50).epsilon(1e-13));
    CHECK(value.effort == Approx(0xBCD / 4095.0 * 36 - 18).epsilon(1e-13));
    for (unsigned error = 1; error < 256; ++error) { // 1 … 6 are documented
        Frame faulty = frame;
        faulty.data[7] = static_cast<std::uint8_t>(error);
        REQUIRE(mit_motor().decode(faulty).joint[0].position_reason == Reason::device_fault);
        REQUIRE(mit_motor().decode(faulty).joint[0].effort_reason == Reason::device_fault);
    }
}

TEST_CASE("old firmware of a CubeMars motor sends six bytes") {
    const Frame frame = frame_of(0x000, {2, 0x9C, 0x40, 0xA1, 0x2B, 0xCD});
    CHECK(mit_motor().decode(frame).joint[0].position_reason == Reason::ok);
    for (const int length : {0, 1, 2, 3, 4, 5, 7}) {
        CHECK(mit_motor().decode(with_length(frame, length)).reason == Reason::wrong_length);
    }
}

TEST_CASE("the motor number of a CubeMars motor in MIT mode is the whole of byte 0") {
    const Frame high = frame_of(0x000, {0x12, 0x9C, 0x40, 0xA1, 0x2B, 0xCD, 31, 0}); // low nibble 2
    CHECK(mit_motor().decode(high).kind == Kind::nothing);
    CHECK(mit_motor().decode(frame_of(0x002, {2, 0x9C, 0x40, 0xA1, 0x2B, 0xCD, 31, 0})).kind ==
          Kind::nothing);
}

TEST_CASE("a CubeMars motor may answer on the identifier of its commands; byte 0 distinguishes them") {
    CubemarsMitMotor::Config config = mit_motor().config();
    config.feedback_id = 2;
    config.shared_feedback_id = false;
    CubemarsMitMotor motor(config);
    const Frame answer = frame_of(0x002, {2, 0x9C, 0x40, 0xA1, 0x2B, 0xCD, 31, 0});
    CHECK(motor.decode(answer).kind == Kind::values);
    CHECK(motor.command(answer) == MotorCommand::none);
    CHECK_FALSE(motor.carries_no_values(answer));
    const Frame command = motor.encode_torque(1);
    CHECK(motor.decode(command).kind == Kind::nothing);
    CHECK(motor.command(command) == MotorCommand::control);
    CHECK(motor.carries_no_values(command));
    const Frame enable = frame_of(0x002, {255, 255, 255, 255, 255, 255, 255, 0xFC});
    CHECK(motor.decode(enable).kind == Kind::nothing);
    CHECK(motor.command(enable) == MotorCommand::enable);
}

/// An AK80-9 in servo mode as motor 0x68.
CubemarsServo::Config servo_config() { return {.motor_id = 0x68, .packet = 0x29, .joint = 3}; }
CubemarsServo servo() { return CubemarsServo(servo_config()); }

Frame extended(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    Frame frame = frame_of(id, bytes);
    frame.extended = true;
    return frame;
}

/// Position 0x0384 = 900: 90°; speed 0xFF38 = -200: -2000 electrical rpm; current 0x00FA = 250: 2.5 A; 38 °C.
Frame upload(std::uint8_t error = 0) {
    return extended(0x2968, {0x03, 0x84, 0xFF, 0x38, 0x00, 0xFA, 38, error});
}

TEST_CASE("a CubeMars motor in servo mode reports degrees, electrical speed and current, big-endian") {
    const Decoded decoded = servo().decode(upload());
    REQUIRE(decoded.kind == Kind::values);
    const JointValue& value = decoded.joint[0];
    CHECK(value.joint == 3);
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == Approx(90 * degree).epsilon(1e-13));
    CHECK(value.step_rad == Approx(0.1 * degree).epsilon(1e-13));
    CHECK(value.velocity == Approx(-2000.0 / 21 / 9 * 360 * degree / 60).epsilon(1e-13));
    CHECK(value.effort == Approx(2.5).epsilon(1e-13));
    CHECK(value.effort_reason == Reason::ok);
}

TEST_CASE("a torque constant makes the currents of a CubeMars servo torques") {
    CubemarsServo::Config config = servo_config();
    config.newton_metre_per_ampere = 9 * 0.091;
    CHECK(CubemarsServo(config).decode(upload()).joint[0].effort == Approx(2.5 * 9 * 0.091).epsilon(1e-13));
    config.newton_metre_per_ampere = 9 * 0.115; // as measured: 26 % more
    const double ratio = CubemarsServo(config).decode(upload()).joint[0].effort / (2.5 * 9 * 0.091);
    CHECK(ratio == Approx(1.2637).epsilon(1e-3));
    const Frame command = CubemarsServo(config).encode_torque(1.035);
    CHECK(command.extended);
    CHECK(command.id == 0x0168); // packet 1
    REQUIRE(command.length == 4);
    CHECK(load_big<std::int32_t>(command.data.data()) == 1000); // mA
    CHECK(CubemarsServo(config).decode_torque(command).value() == Approx(1.035));
}

TEST_CASE("an error of a CubeMars servo invalidates its values") {
    for (unsigned error = 1; error < 256; ++error) {
        const JointValue value = servo().decode(upload(static_cast<std::uint8_t>(error))).joint[0];
        REQUIRE(value.position_reason == (error == 5 ? Reason::encoder_fault : Reason::device_fault));
        REQUIRE(value.effort_reason != Reason::ok);
    }
}

TEST_CASE("commands to a CubeMars servo are not decoded as feedback") {
    for (std::uint32_t packet = 1; packet <= 8; ++packet) {
        CubemarsServo::Config config = servo_config();
        config.packet = -1;
        const Frame command = extended(packet << 8 | 0x68, {0x03, 0x84, 0xFF, 0x38, 0x00, 0xFA, 38, 0});
        CHECK(CubemarsServo(config).decode(command).kind == Kind::nothing);
        CHECK(servo().command(command) == (packet == 5 ? MotorCommand::set_zero : MotorCommand::control));
    }
    CHECK(servo().decode(extended(0x2969, {0, 1, 0, 0, 0, 0, 30, 0})).kind == Kind::nothing);
    Frame standard = upload();
    standard.extended = false;
    CHECK(servo().decode(standard).kind == Kind::nothing);
}

TEST_CASE("without a packet number, a frame of eight bytes is a CubeMars servo's feedback") {
    CubemarsServo::Config config = servo_config();
    config.packet = -1;
    for (const std::uint32_t id : {0x2968U, 0x0068U, 0x0968U}) {
        Frame frame = upload();
        frame.id = id;
        CHECK(CubemarsServo(config).decode(frame).kind == Kind::values);
    }
    CHECK(CubemarsServo(config).decode(extended(0x0068, {0, 0, 0x10, 0})).kind ==
          Kind::nothing); // a duty cycle
}

TEST_CASE("CubeMars servo values at the end of their range are invalid") {
    for (const int counts : {32'000, -32'000}) {
        Frame frame = upload();
        store_big(frame.data.data(), static_cast<std::int16_t>(counts));
        CHECK(servo().decode(frame).joint[0].position_reason == Reason::position_out_of_range);
    }
    Frame frame = upload();
    store_big(frame.data.data() + 4, std::int16_t{-32768});
    CHECK(servo().decode(frame).joint[0].effort_reason == Reason::output_saturated);
    for (int length = 1; length < 8; ++length) {
        CHECK(servo().decode(with_length(upload(), length)).reason == Reason::wrong_length);
    }
}

TEST_CASE("a simulated CubeMars servo's feedback is decoded to half a count") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-3, 3);
    CubemarsServo::Config config = servo_config();
    config.motor_per_joint = -2;
    CubemarsServo motor(config);
    for (int i = 0; i < 300; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = uniform(engine);
        values[0].effort = uniform(engine);
        const JointValue seen = motor.decode(motor.encode(values).frame[0]).joint[0];
        REQUIRE(std::abs(seen.position_rad - values[0].position_rad) < 0.501 * 0.05 * degree);
        REQUIRE(std::abs(seen.effort - values[0].effort) < 0.501 * 0.01);
    }
}

} // namespace cubemars_test
