// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/robstride.hpp"

#include "dfdyn/hal/device/damiao.hpp"
#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace robstride_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr double four_pi = 12.566370614359172;

/// A CyberGear as motor 0x7F of host 0xFD.
RobstrideMotor::Config wrist_config() {
    return {.motor_id = 0x7F, .host_id = 0xFD, .joint = 5, .velocity_max = 30, .torque_max = 12};
}
RobstrideMotor wrist() { return RobstrideMotor(wrist_config()); }

/// A frame of the private protocol: type, bits 23 to 8, bits 7 to 0 of the identifier, and eight bytes.
Frame private_frame(unsigned type, unsigned data, unsigned target, std::initializer_list<std::uint8_t> bytes,
                    std::int64_t stamp_ns = 0) {
    Frame frame = frame_of(type << 24 | data << 8 | target, bytes, stamp_ns);
    frame.extended = true;
    return frame;
}

/// Feedback of motor 0x7F to host 0xFD in a mode and with fault bits (bits 23 … 16 of the identifier).
Frame feedback(unsigned mode, unsigned faults, std::initializer_list<std::uint8_t> bytes) {
    return private_frame(2, (mode << 6 | faults) << 8 | 0x7F, 0xFD, bytes);
}

/// In run mode, far from the ends of all codes, 28.5 °C.
Frame sound(std::uint8_t angle_high = 0xA0) {
    return feedback(2, 0, {angle_high, 0x01, 0x90, 0x02, 0x70, 0x03, 0x01, 0x1D});
}

JointValue value_of(const Frame& frame) { return wrist().decode(frame).joint[0]; }

TEST_CASE("a Robstride feedback has four big-endian numbers of 16 bits") {
    Frame frame = sound();
    frame.stamp_ns = 88;
    const Decoded decoded = wrist().decode(frame);
    REQUIRE(decoded.kind == Kind::values);
    const JointValue& value = decoded.joint[0];
    CHECK(value.joint == 5);
    CHECK(value.stamp_ns == 88);
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == Approx(0xA001 / 65535.0 * 2 * four_pi - four_pi).epsilon(1e-13));
    CHECK(value.velocity == Approx(0x9002 / 65535.0 * 60 - 30).epsilon(1e-13));
    CHECK(value.effort_reason == Reason::ok);
    CHECK(value.effort == Approx(0x7003 / 65535.0 * 24 - 12).epsilon(1e-13));
    CHECK(RobstrideMotor::temperature(frame) == Approx(28.5));
}

TEST_CASE("a Robstride value is valid in run mode only") {
    CHECK(value_of(feedback(0, 0, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29})).position_reason ==
          Reason::device_not_operational);
    CHECK(value_of(feedback(1, 0, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29})).effort_reason ==
          Reason::device_not_operational);
    CHECK(value_of(feedback(3, 0, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29})).position_reason ==
          Reason::device_fault);
}

TEST_CASE("each Robstride fault bit invalidates the values, and encoder bits give encoder_fault") {
    for (unsigned bit = 0; bit < 6;
         ++bit) { // voltage, current, temperature, magnetic encoder, Hall, calibration
        const JointValue value = value_of(feedback(2, 1U << bit, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29}));
        CAPTURE(bit);
        CHECK(value.position_reason == (bit >= 3 ? Reason::encoder_fault : Reason::device_fault));
        CHECK(value.effort_reason != Reason::ok);
    }
}

TEST_CASE("a Robstride angle saturated at 4π is invalid") {
    for (const std::uint8_t end : {std::uint8_t{0}, std::uint8_t{255}}) {
        const JointValue value = value_of(feedback(2, 0, {end, end, 0x90, 2, 0x70, 3, 1, 29}));
        CHECK(value.position_reason == Reason::position_out_of_range);
        CHECK(value.effort_reason == Reason::ok);
    }
    CHECK(value_of(feedback(2, 0, {0xA0, 1, 0x90, 2, 0xFF, 0xFF, 1, 29})).effort_reason ==
          Reason::output_saturated);
    CHECK(value_of(feedback(2, 0, {0x80, 0, 0x90, 2, 0x70, 3, 1, 29})).raw_zero);
}

TEST_CASE("Robstride parameters are little-endian and are not decoded as feedback") {
    // mechPos (0x7019) = 1.0F, as answer of motor 0x7F to host 0xFD
    const Frame answer = private_frame(17, 0x7F, 0xFD, {0x19, 0x70, 0, 0, 0, 0, 0x80, 0x3F});
    CHECK(wrist().decode(answer).kind == Kind::nothing);
    CHECK(wrist().concerns(answer));
    for (unsigned type = 0; type < 32; ++type) {
        if (type != 2 && type != 21) {
            CHECK(wrist().decode(private_frame(type, 0x7F, 0xFD, {1, 2, 3, 4, 5, 6, 7, 8})).kind ==
                  Kind::nothing);
        }
    }
}

TEST_CASE("answers of a Robstride motor to another host are ignored") {
    const Frame other = private_frame(2, 2U << 14 | 0x7F, 0xFE, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29});
    CHECK(wrist().decode(other).kind == Kind::nothing);
    CHECK(wrist().concerns(other));
    CHECK(RobstrideMotor::is_feedback_to_other(wrist_config(), other));
    CHECK_FALSE(RobstrideMotor::is_feedback_to_other(wrist_config(), sound()));
    const Frame neighbour = private_frame(2, 2U << 14 | 0x7E, 0xFD, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29});
    CHECK(wrist().decode(neighbour).kind == Kind::nothing);
    CHECK_FALSE(wrist().concerns(neighbour));
}

TEST_CASE("a Robstride fault frame is accepted with host and motor in either order") {
    for (const auto& [data, target] : {std::pair(0xFDU, 0x7FU), std::pair(0x7FU, 0xFDU)}) {
        RobstrideMotor motor = wrist();
        CHECK(motor.decode(sound()).joint[0].position_reason == Reason::ok);
        const Frame fault = private_frame(21, data, target, {0, 0x40, 0, 0, 0, 0, 0, 0}); // bit 14: overload
        CHECK(motor.decode(fault).reason == Reason::device_fault);
        CHECK(motor.decode(sound()).joint[0].position_reason == Reason::device_fault);
        const Frame none = private_frame(21, data, target, {0, 0, 0, 0, 0, 0, 0, 0});
        CHECK(motor.decode(none).reason == Reason::ok);
        CHECK(motor.decode(sound()).joint[0].position_reason == Reason::ok);
    }
}

TEST_CASE("a Robstride fault ends when the motor is enabled again") {
    RobstrideMotor motor = wrist();
    motor.decode(sound());
    motor.decode(private_frame(21, 0x7F, 0xFD, {1, 0, 0, 0, 0, 0, 0, 0}));
    CHECK(motor.decode(sound()).joint[0].effort_reason == Reason::device_fault);
    motor.decode(feedback(0, 0, {0xA0, 1, 0x90, 2, 0x70, 3, 1, 29}));
    CHECK(motor.decode(sound()).joint[0].effort_reason == Reason::ok);
}

TEST_CASE("Robstride frames have eight bytes of classic data and 29-bit identifiers") {
    for (int length = 0; length < 8; ++length) {
        CHECK(wrist().decode(with_length(sound(), length)).reason == Reason::wrong_length);
    }
    Frame flexible = sound();
    flexible.fd = true;
    CHECK(wrist().decode(flexible).reason == Reason::wrong_frame_type);
    Frame remote = sound();
    remote.remote = true;
    CHECK(wrist().decode(remote).reason == Reason::wrong_frame_type);
    Frame standard = sound();
    standard.extended = false;
    CHECK(wrist().decode(standard).kind == Kind::nothing);
    Frame error = sound();
    error.error = true;
    error.extended = false;
    CHECK(wrist().decode(error).kind == Kind::nothing);
    for (std::uint32_t id = 0; id < 0x800; ++id) {
        REQUIRE_FALSE(wrist().claims(id));
    }
}

TEST_CASE("a torque command to a Robstride motor has the torque in the identifier") {
    const Frame command = wrist().encode_torque(6);
    CHECK(command.extended);
    CHECK(command.id >> 24 == 1);
    CHECK((command.id & 0xFF) == 0x7F);
    CHECK(std::abs(static_cast<int>(command.id >> 8 & 0xFFFF) - 0xBFFF) <= 1); // 3/4 of 65535
    CHECK(load_big<std::uint32_t>(command.data.data() + 4) == 0);              // kp, kd
    CHECK(wrist().decode_torque(command).value() == Approx(6).margin(24 / 65535.0));
    Frame stiff = command;
    stiff.data[5] = 1;
    CHECK_FALSE(wrist().decode_torque(stiff));
    CHECK(wrist().command(command) == MotorCommand::control);
    CHECK(wrist().command(private_frame(3, 0xFD, 0x7F, {0, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::enable);
    CHECK(wrist().command(private_frame(4, 0xFD, 0x7F, {0, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::disable);
    CHECK(wrist().command(private_frame(4, 0xFD, 0x7F, {1, 0, 0, 0, 0, 0, 0, 0})) ==
          MotorCommand::clear_faults);
    CHECK(wrist().command(private_frame(6, 0xFD, 0x7F, {1, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::set_zero);
    CHECK(wrist().command(private_frame(17, 0xFD, 0x7F, {0x19, 0x70, 0, 0, 0, 0, 0, 0})) ==
          MotorCommand::read);
    CHECK(wrist().command(private_frame(3, 0xFD, 0x7E, {0, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::none);
}

TEST_CASE("a Robstride motor's feedback has one stream identifier in all modes and with all faults") {
    const std::uint32_t running = sound().id;
    for (unsigned mode = 0; mode < 4; ++mode) {
        for (const unsigned faults : {0x00U, 0x01U, 0x20U, 0x3FU}) {
            CHECK(RobstrideMotor::stream_id(feedback(mode, faults, {0, 0, 0, 0, 0, 0, 0, 0})) == running);
        }
    }
    const Frame other = private_frame(2, 2U << 14 | 0x7E, 0xFD, {0, 0, 0, 0, 0, 0, 0, 0});
    CHECK(RobstrideMotor::stream_id(other) == other.id);
    const Frame command = wrist().encode_torque(6);
    CHECK(RobstrideMotor::stream_id(command) == command.id);
}

TEST_CASE("an answer of a Robstride motor to a host is attributed to the motor") {
    // bits 15 to 8 are the motor; an answer to type 0 has the target 0xFE
    CHECK(RobstrideMotor::answering_motor(private_frame(17, 0x7F, 0xFD, {0x19, 0x70})) == 0x7FU);
    CHECK(RobstrideMotor::answering_motor(private_frame(0, 0x7F, 0xFE, {1, 2, 3, 4, 5, 6, 7, 8})) == 0x7FU);
    CHECK(RobstrideMotor::answering_motor(sound()) == 0x7FU);
    CHECK_FALSE(RobstrideMotor::answering_motor(private_frame(3, 0xFD, 0x7F, {})));
    CHECK_FALSE(RobstrideMotor::answering_motor(wrist().encode_torque(6)));
}

TEST_CASE("a simulated Robstride motor's feedback is decoded to half a count") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-11, 11);
    RobstrideMotor::Config config = wrist_config();
    config.motor_per_joint = -1.5;
    config.zero_rad = 0.25;
    RobstrideMotor motor(config);
    for (int i = 0; i < 500; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = uniform(engine) / 1.6;
        values[0].effort = uniform(engine);
        values[0].has_velocity = true;
        values[0].velocity = uniform(engine);
        const JointValue seen = motor.decode(motor.encode(values).frame[0]).joint[0];
        REQUIRE(seen.position_reason == Reason::ok);
        REQUIRE(std::abs(seen.position_rad - values[0].position_rad) < 0.501 * seen.step_rad);
        REQUIRE(std::abs(seen.velocity - values[0].velocity) < 0.501 * 60 / 65535 / 1.5);
        REQUIRE(std::abs(seen.effort - values[0].effort) < 0.501 * 24 / 65535 * 1.5);
    }
}

/// Feedback in MIT mode of motor 3, on the identifier of host 0xFD.
Frame mit_feedback(unsigned motor, unsigned temperature) {
    return frame_of(0xFD,
                    {static_cast<std::uint8_t>(motor), 0x9C, 0x40, 0xA1, 0x2B, 0xCD,
                     static_cast<std::uint8_t>(temperature >> 8), static_cast<std::uint8_t>(temperature)});
}

RobstrideMitMotor mit_motor(int id) {
    return RobstrideMitMotor({.motor_id = id,
                              .feedback_id = 0xFD,
                              .joint = 2,
                              .position_max = 12.57,
                              .velocity_max = 33,
                              .torque_max = 14,
                              .shared_feedback_id = true});
}

TEST_CASE("a Robstride motor in MIT mode has one temperature of two bytes") {
    const Frame frame = mit_feedback(3, 285);
    const JointValue value = mit_motor(3).decode(frame).joint[0];
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == Approx(40000 / 65535.0 * 25.14 - 12.57).epsilon(1e-13));
    CHECK(value.velocity == Approx(0xA12 / 4095.0 * 66 - 33).epsilon(1e-13));
    CHECK(value.effort == Approx(0xBCD / 4095.0 * 28 - 14).epsilon(1e-13));
    CHECK(RobstrideMitProtocol::temperature(frame) == Approx(28.5));
    CHECK(frame.data[6] == 1);  // as Damiao's transistor 1 °C
    CHECK(frame.data[7] == 29); // as Damiao's rotor 29 °C
}

TEST_CASE("Robstride motors in MIT mode share an identifier; byte 0 distinguishes them") {
    CHECK(mit_motor(3).decode(mit_feedback(4, 285)).kind == Kind::nothing);
    CHECK(mit_motor(4).decode(mit_feedback(4, 285)).kind == Kind::values);
    CHECK_FALSE(mit_motor(3).claims(0xFD));
    CHECK(mit_motor(3).concerns(mit_feedback(4, 285)));
    // byte 0 alone is not enough: the same bytes on the identifier of a command
    Frame command = mit_feedback(3, 285);
    command.id = 3;
    CHECK(mit_motor(3).decode(command).kind == Kind::nothing);
}

TEST_CASE("a poll that clears the faults of a Robstride motor is recognised and gives no value") {
    const Frame clear = frame_of(0x003, {255, 255, 255, 255, 255, 255, 255, 0xFB});
    CHECK(mit_motor(3).decode(clear).kind == Kind::nothing);
    CHECK(mit_motor(3).command(clear) == MotorCommand::clear_faults);
    CHECK(mit_motor(4).command(clear) == MotorCommand::none);
    CHECK(mit_motor(3).command(frame_of(0x003, {255, 255, 255, 255, 255, 255, 255, 0xFC})) ==
          MotorCommand::enable);
    CHECK_FALSE(mit_motor(3).decode_torque(clear));
}

} // namespace robstride_test
