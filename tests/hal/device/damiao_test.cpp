// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/damiao.hpp"

#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/sample_assembly.hpp"
#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <cstring>
#include <optional>

namespace damiao_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr std::int64_t ms = 1'000'000;

/// A DM4310 as motor 4, which replies on 0x14.
DamiaoMotor::Config elbow_config() {
    return {.motor_id = 4,
            .feedback_id = 0x14,
            .joint = 3,
            .position_max = 12.5,
            .velocity_max = 30,
            .torque_max = 10};
}
DamiaoMotor elbow() { return DamiaoMotor(elbow_config()); }

/// Returns the code of a value, computed as in the manufacturers' examples: rounded down.
unsigned code(double value, double maximum, int bits) {
    return static_cast<unsigned>((value + maximum) * ((1 << bits) - 1) / (2 * maximum));
}

/// A feedback frame from its codes.
Frame feedback_of(unsigned state, unsigned motor, unsigned position, unsigned velocity, unsigned torque,
                  std::int64_t stamp_ns = 0) {
    const auto byte = [](unsigned value) { return static_cast<std::uint8_t>(value & 0xFF); };
    return frame_of(0x10 + motor,
                    {byte(state << 4 | motor), byte(position >> 8), byte(position), byte(velocity >> 4),
                     byte((velocity & 0xF) << 4 | torque >> 8), byte(torque), 35, 41},
                    stamp_ns);
}

/// The feedback of an enabled DM4310 at rest.
Frame feedback(unsigned motor, double position_rad, double torque_Nm, std::int64_t stamp_ns = 0) {
    return feedback_of(1, motor, code(position_rad, 12.5, 16), code(0, 30, 12), code(torque_Nm, 10, 12),
                       stamp_ns);
}

/// A motor's reply about a register.
Frame answer(unsigned motor, int what, int number, float value) {
    const auto byte = [](auto field) { return static_cast<std::uint8_t>(field); };
    Frame frame = frame_of(0x10 + motor, {byte(motor), 0, byte(what), byte(number), 0, 0, 0, 0});
    std::memcpy(frame.data.data() + 4, &value, 4); // on a little-endian host
    return frame;
}

JointValue value_of(const Frame& frame) { return elbow().decode(frame).joint[0]; }

TEST_CASE("a Damiao motor's feedback is big-endian with velocity and torque in nibbles of one byte") {
    const Frame frame = frame_of(0x14, {0x14, 0x9C, 0x40, 0xA1, 0x2B, 0xCD, 30, 31}, 77);
    DamiaoMotor motor = elbow();
    const Decoded decoded = motor.decode(frame);
    REQUIRE(decoded.kind == Kind::values);
    REQUIRE(decoded.joints == 1);
    const JointValue& value = decoded.joint[0];
    CHECK(value.joint == 3);
    CHECK(value.stamp_ns == 77);
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == Approx(40000 / 65535.0 * 25 - 12.5).epsilon(1e-14));
    CHECK(value.step_rad == Approx(25 / 65535.0).epsilon(1e-14));
    CHECK(value.wrap_rad == 0); // its code does not wrap
    CHECK_FALSE(value.raw_zero);
    CHECK(value.effort_reason == Reason::ok);
    CHECK(value.effort == Approx(0xBCD / 4095.0 * 20 - 10).epsilon(1e-14));
    CHECK(motor.decode(frame).joint[0].velocity == Approx(0xA12 / 4095.0 * 60 - 30).epsilon(1e-14));
}

TEST_CASE("TMAX scales the torque of a feedback and PMAX its position") {
    DamiaoMotor::Config config = elbow_config();
    config.position_max = 25;
    config.torque_max = 54;
    const Frame frame = feedback(4, 1, 5);
    const JointValue value = DamiaoMotor(config).decode(frame).joint[0];
    CHECK(value.position_rad == Approx(2 * value_of(frame).position_rad).epsilon(1e-12));
    CHECK(value.effort == Approx(5.4 * value_of(frame).effort).epsilon(1e-12));
}

TEST_CASE("a Damiao motor's joint has the transmission's direction and zero") {
    DamiaoMotor::Config config = elbow_config();
    config.motor_per_joint = -2;
    config.zero_rad = 0.5;
    const JointValue value = DamiaoMotor(config).decode(feedback(4, 1, 3)).joint[0];
    CHECK(value.position_rad == Approx(0).margin(2e-4));
    CHECK(value.from_zero_rad == Approx(-0.5).margin(2e-4));
    CHECK(value.effort == Approx(-6).margin(1e-2));
    CHECK(value.step_rad == Approx(12.5 / 65535).epsilon(1e-12));
}

TEST_CASE("a Damiao motor's values are valid only in the enabled state and unknown states are faults") {
    for (unsigned state = 0; state < 16; ++state) {
        const JointValue value = value_of(feedback_of(state, 4, 40'000, 2048, 2048));
        const Reason expected = state == 1   ? Reason::ok
                                : state == 0 ? Reason::device_not_operational
                                             : Reason::device_fault;
        CAPTURE(state);
        CHECK(value.position_reason == expected);
        CHECK(value.effort_reason == expected);
    }
}

TEST_CASE("a Damiao motor's register reply is not decoded as feedback") {
    for (const int what : {0x33, 0x55, 0xAA}) {
        for (int number = 0; number < 256; ++number) {
            CHECK(elbow().decode(answer(4, what, number, 12.5F)).kind != Kind::values);
        }
    }
}

TEST_CASE("another program's poll of a Damiao motor is not decoded as feedback on any identifier") {
    CHECK(elbow().decode(frame_of(0x7FF, {4, 0, 0xCC, 0})).kind == Kind::nothing);
    // decoded as feedback it would be a position of -12.42 rad
    CHECK(elbow().decode(frame_of(0x14, {4, 0, 0xCC, 0, 0, 0, 0, 0})).kind == Kind::nothing);
    CHECK(elbow().decode(frame_of(0x7FF, {4, 0, 0x33, 21})).kind == Kind::nothing);
}

TEST_CASE("a Damiao motor's commands are not decoded as feedback") {
    CHECK(elbow().decode(frame_of(0x004, {0x7F, 0xFF, 0x7F, 0xF0, 0, 0, 7, 0xFF})).kind == Kind::nothing);
    CHECK(elbow().decode(frame_of(0x004, {255, 255, 255, 255, 255, 255, 255, 0xFC})).kind == Kind::nothing);
    CHECK_FALSE(elbow().claims(0x004));
    CHECK_FALSE(elbow().claims(0x7FF));
    CHECK(elbow().claims(0x014));
}

TEST_CASE("frames of other lengths are no commands of a Damiao motor's other modes") {
    const auto of_length = [](std::uint32_t mode, int length) {
        return elbow().command(make_frame(mode + 4, length));
    };
    for (int length = 0; length <= 8; ++length) { // such as the PDOs of a CANopen drive
        CHECK((of_length(0x100, length) == MotorCommand::other_mode) == (length == 8));
        CHECK((of_length(0x200, length) == MotorCommand::other_mode) == (length == 4 || length == 8));
        CHECK((of_length(0x300, length) == MotorCommand::other_mode) == (length == 8));
    }
    CHECK(elbow().command(frame_of(0x7FF, {4, 0, 0xCC, 0, 0, 0, 0, 0})) == MotorCommand::poll);
    CHECK(elbow().command(frame_of(0x7FF, {4, 0, 0x33, 21, 0, 0, 0, 0})) == MotorCommand::read);
    CHECK(elbow().command(frame_of(0x7FF, {4, 0, 0x55, 21, 0, 0, 0, 0})) == MotorCommand::configure);
}

TEST_CASE("a Damiao motor that reports another scale than described rejects the values that depend on it") {
    DamiaoMotor motor = elbow();
    const Frame frame = feedback(4, 1, 5);
    CHECK(motor.decode(answer(4, 0x33, 23, 28.0F)).reason == Reason::full_scale_contradicted);
    CHECK(motor.decode(frame).joint[0].position_reason == Reason::ok);
    CHECK(motor.decode(frame).joint[0].effort_reason == Reason::full_scale_contradicted);
    CHECK(motor.decode(answer(4, 0x55, 23, 10.0F)).reason == Reason::ok);
    CHECK(motor.decode(frame).joint[0].effort_reason == Reason::ok);
    motor.decode(answer(4, 0x33, 21, 12.566F));
    CHECK(motor.decode(frame).joint[0].position_reason == Reason::full_scale_contradicted);
    motor.decode(answer(4, 0x33, 21, std::nanf("")));
    CHECK(motor.decode(frame).joint[0].position_reason == Reason::full_scale_contradicted);
    motor.decode(answer(4, 0x33, 21, 12.5F));
    CHECK(motor.decode(frame).joint[0].position_reason == Reason::ok);
}

TEST_CASE("a Damiao motor's position and torque saturate at the ends of their codes without wrapping") {
    for (const unsigned end : {0U, 0xFFFFU}) {
        const JointValue value = value_of(feedback_of(1, 4, end, 2048, 2048));
        CHECK(value.position_reason == Reason::position_out_of_range);
        CHECK(value.effort_reason == Reason::ok);
    }
    for (const unsigned end : {0U, 0xFFFU}) {
        const JointValue value = value_of(feedback_of(1, 4, 40'000, 2048, end));
        CHECK(value.position_reason == Reason::ok);
        CHECK(value.effort_reason == Reason::output_saturated);
    }
    std::array<JointValue, 1> far{};
    far[0].position_rad = 13;
    far[0].effort = -11;
    const JointValue sent = value_of(elbow().encode(far).frame[0]);
    CHECK(sent.position_reason == Reason::position_out_of_range);
    CHECK(sent.effort_reason == Reason::output_saturated);
}

TEST_CASE("a Damiao motor at position 0 may have no position yet") {
    CHECK(value_of(feedback(4, 0, 0)).raw_zero);
    CHECK(value_of(feedback_of(1, 4, 0x8000, 0, 5)).raw_zero);
    CHECK_FALSE(value_of(feedback_of(1, 4, 0x8001, 0, 5)).raw_zero);
}

TEST_CASE("a Damiao motor's frames have eight bytes in classic CAN or CAN FD and its own motor id") {
    const Frame good = feedback(4, 1, 2);
    for (int length = 0; length < 8; ++length) {
        CHECK(elbow().decode(with_length(good, length)).reason == Reason::wrong_length);
    }
    Frame remote = good;
    remote.remote = true;
    CHECK(elbow().decode(remote).reason == Reason::wrong_frame_type);
    Frame flexible = good;
    flexible.fd = flexible.bit_rate_switch = true;
    CHECK(elbow().decode(flexible).kind == Kind::values);
    flexible.length = 12;
    CHECK(elbow().decode(flexible).reason == Reason::wrong_length);
    Frame extended = good;
    extended.extended = true;
    CHECK(elbow().decode(extended).kind == Kind::nothing);
    Frame error = good;
    error.error = true;
    CHECK(elbow().decode(error).kind == Kind::nothing);
    Frame other = feedback(5, 1, 2);
    other.id = good.id;
    CHECK(elbow().decode(other).kind == Kind::rejected);
    CHECK(elbow().decode(other).reason == Reason::id_collision);
}

TEST_CASE("a simulated Damiao motor's codes equal those of the manufacturers' examples within one count") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> angle(-12, 12);
    std::uniform_real_distribution<double> torque(-9.9, 9.9);
    for (int i = 0; i < 1000; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = angle(engine);
        values[0].effort = torque(engine);
        const Frame sent = elbow().encode(values).frame[0];
        const Frame expected = feedback(4, values[0].position_rad, values[0].effort);
        REQUIRE(sent.id == expected.id);
        REQUIRE(sent.length == 8);
        REQUIRE(sent.data[0] == expected.data[0]);
        REQUIRE(std::abs(value_of(sent).position_rad - value_of(expected).position_rad) < 25.001 / 65535);
        REQUIRE(std::abs(value_of(sent).effort - value_of(expected).effort) < 20.001 / 4095);
        REQUIRE(std::abs(value_of(sent).position_rad - values[0].position_rad) < 12.501 / 65535);
        REQUIRE(std::abs(value_of(sent).effort - values[0].effort) < 10.001 / 4095);
        REQUIRE(std::abs(value_of(sent).velocity) < 30.001 / 4095);
    }
}

TEST_CASE(
    "a torque command to a Damiao motor has no stiffness and damping and other commands are not decoded") {
    const Frame command = elbow().encode_torque(5);
    CHECK(command.id == 0x004);
    REQUIRE(command.length == 8);
    CHECK(command.data[3] % 16 == 0); // kp, kd
    CHECK(command.data[4] == 0);
    CHECK(command.data[5] == 0);
    CHECK(command.data[6] / 16 == 0);
    CHECK(std::abs(256 * (command.data[6] % 16) + command.data[7] - 0xBFF) <= 1); // 3/4 of 4095
    CHECK(elbow().decode_torque(command).value() == Approx(5).margin(10.001 / 4095));
    Frame stiff = command;
    stiff.data[4] = 1;
    CHECK_FALSE(elbow().decode_torque(stiff));
    CHECK_FALSE(elbow().decode_torque(frame_of(0x004, {255, 255, 255, 255, 255, 255, 255, 0xFC})));
    CHECK_FALSE(elbow().decode_torque(frame_of(0x003, {0, 0, 0, 0, 0, 0, 0, 0})));
    CHECK_FALSE(elbow().decode_torque(with_length(command, 7)));
}

/// An arm of motors 1 and 2.
using Arm = SampleAssembly<double, 2, DamiaoMotor, 2, EffortOutput<2, 16>>;

Arm arm() {
    DamiaoMotor::Config first = elbow_config();
    first.motor_id = 1;
    first.feedback_id = 0x11;
    first.joint = 0;
    DamiaoMotor::Config second = first;
    second.motor_id = 2;
    second.feedback_id = 0x12;
    second.joint = 1;
    const TrackConfig track{.max_age_ns = 3 * ms, .latency_ns = 0, .qualification = {}, .period_ns = ms};
    return Arm({.board = {DamiaoMotor(first), DamiaoMotor(second)},
                .position = track,
                .position_range = {Range{-3, 3}, Range{-3, 3}},
                .clock = {}},
               EffortOutput<2, 16>({.track = track, .range = {Range{-10, 10}, Range{-10, 10}}}));
}

/// Runs a motion of the joints for several milliseconds. `second`: makes the feedback of the second motor.
template <class Second>
Arm::Assembled run(Arm& arm, int from, int to, Second second) {
    for (int i = from; i < to; ++i) {
        const double angle = 0.5 + 5e-4 * i;
        arm.take(feedback(1, angle, 1 + 0.01 * (i % 7), i * ms), i * ms);
        if (const std::optional<Frame> frame = second(angle, i * ms)) {
            arm.take(*frame, i * ms);
        }
    }
    return arm.assemble((to - 1) * ms, (to - 1) * ms);
}

std::optional<Frame> sound(double angle, std::int64_t stamp_ns) {
    return feedback(2, -angle, 2 + 0.5 * angle, stamp_ns);
}

TEST_CASE("a Damiao motor that never replies is a missing joint and not one at zero") {
    Arm silent = arm();
    const auto assembled = run(silent, 0, 200, [](double, std::int64_t) { return std::optional<Frame>(); });
    CHECK_FALSE(assembled.valid());
    CHECK(assembled.report.joint == 1);
    CHECK(assembled.report.joint_reason[0] == Reason::ok);
    CHECK(assembled.report.joint_reason[1] != Reason::ok);
    Arm answering = arm();
    const auto both = run(answering, 0, 200, sound);
    REQUIRE(both.valid());
    CHECK(both.sample.position[1] == Approx(-0.5 - 5e-4 * 199).margin(4e-4));
    CHECK(both.sample.output_valid);
}

TEST_CASE("the last value of a silent Damiao motor expires") {
    Arm bus = arm();
    REQUIRE(run(bus, 0, 200, sound).valid());
    const auto assembled = run(bus, 200, 210, [](double, std::int64_t) { return std::optional<Frame>(); });
    CHECK_FALSE(assembled.valid());
    CHECK(assembled.report.joint == 1);
}

TEST_CASE("a single wrong position of a Damiao motor near -PMAX gives no sample and the next position does") {
    Arm bus = arm();
    REQUIRE(run(bus, 0, 200, sound).valid());
    const auto stray = run(bus, 200, 201, [](double, std::int64_t stamp_ns) {
        return std::optional(feedback_of(1, 2, 0x00CC, 2048, 2048, stamp_ns));
    });
    CHECK(stray.report.joint_reason[1] == Reason::position_out_of_range);
    CHECK(run(bus, 201, 240, sound).valid());
}

} // namespace damiao_test
