// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/rmd.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace rmd_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

constexpr double degree = 3.14159265358979323846 / 180;

RmdMotor motor(RmdDriver driver = RmdDriver::v3, RmdPosition position = RmdPosition::multi_turn) {
    return RmdMotor({.motor_id = 5, .joint = 4, .driver = driver, .position = position});
}

/// The example of the manual for 0x9C: 50 °C, 1 A, 500 °/s, 45°.
Frame status_answer(std::uint32_t id = 0x245) {
    return frame_of(id, {0x9C, 0x32, 0x64, 0x00, 0xF4, 0x01, 0x2D, 0x00});
}

TEST_CASE("an RMD motor's multi-turn angle is little-endian in hundredths of a degree") {
    const Decoded decoded =
        motor().decode(frame_of(0x245, {0x92, 0, 0, 0, 0xF0, 0xD8, 0xFF, 0xFF}, 9)); // -10000
    REQUIRE(decoded.kind == Kind::values);
    CHECK(decoded.joint[0].joint == 4);
    CHECK(decoded.joint[0].stamp_ns == 9);
    CHECK(decoded.joint[0].position_reason == Reason::ok);
    CHECK(decoded.joint[0].position_rad == Approx(-100 * degree).epsilon(1e-13));
    CHECK(decoded.joint[0].step_rad == Approx(0.01 * degree).epsilon(1e-13));
    CHECK(decoded.joint[0].effort_reason == Reason::no_output);
}

TEST_CASE("an RMD motor's status has current and speed and its angle of one degree is not a position") {
    const JointValue value = motor().decode(status_answer()).joint[0];
    CHECK(value.effort_reason == Reason::ok);
    CHECK(value.effort == Approx(1).epsilon(1e-13));
    CHECK(value.has_velocity);
    CHECK(value.velocity == Approx(500 * degree).epsilon(1e-13));
    CHECK(value.position_reason == Reason::waiting_for_position);
    const JointValue coarse = motor(RmdDriver::v3, RmdPosition::status).decode(status_answer()).joint[0];
    CHECK(coarse.position_reason == Reason::ok);
    CHECK(coarse.position_rad == Approx(45 * degree).epsilon(1e-13));
    CHECK(coarse.step_rad == Approx(degree).epsilon(1e-13));
}

TEST_CASE("an RMD motor's encoder counts are positions if configured") {
    const Frame answer = frame_of(0x245, {0x60, 0, 0, 0, 0x00, 0x00, 0x01, 0x00}); // 65536
    CHECK(motor().decode(answer).kind == Kind::nothing);
    CHECK(motor(RmdDriver::v3, RmdPosition::encoder).decode(answer).joint[0].position_rad ==
          Approx(360 * degree).epsilon(1e-13));
}

TEST_CASE("requests to an RMD motor are not decoded as answers") {
    for (const unsigned number : {0x60U, 0x92U, 0x9AU, 0x9CU, 0xA1U}) {
        const auto command = static_cast<std::uint8_t>(number);
        CHECK(motor().decode(frame_of(0x145, {command, 0, 0, 0, 0x64, 0, 0, 0})).kind == Kind::nothing);
        CHECK(motor(RmdDriver::v2).decode(frame_of(0x145, {command, 0, 0, 0, 0, 0, 0, 0})).kind ==
              Kind::nothing);
    }
    CHECK(motor(RmdDriver::v2).decode(frame_of(0x145, {0xA1, 0, 0, 0, 0x64, 0, 0, 0})).kind == Kind::nothing);
    CHECK(motor().concerns(frame_of(0x145, {0x9C, 0, 0, 0, 0, 0, 0, 0})));
}

TEST_CASE("a V2 driver of an RMD motor answers on the identifier of the requests with other scales") {
    const JointValue value = motor(RmdDriver::v2).decode(status_answer(0x145)).joint[0];
    CHECK(value.effort == Approx(100 * 33.0 / 2048).epsilon(1e-13));
    CHECK(motor(RmdDriver::v2).decode(status_answer(0x245)).kind == Kind::nothing);
    CHECK(motor(RmdDriver::v3).decode(status_answer(0x145)).kind == Kind::nothing);
    const JointValue coarse =
        motor(RmdDriver::v2, RmdPosition::status)
            .decode(frame_of(0x145, {0x9C, 0x32, 0x64, 0x00, 0xF4, 0x01, 0x00, 0x20})) // 8192 of 16384
            .joint[0];
    CHECK(coarse.position_rad == Approx(180 * degree).epsilon(1e-13));
    CHECK(coarse.wrap_rad == Approx(360 * degree).epsilon(1e-13));
    const JointValue turns = motor(RmdDriver::v2) // seven bytes, -36000
                                 .decode(frame_of(0x145, {0x92, 0x60, 0x73, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}))
                                 .joint[0];
    CHECK(turns.position_rad == Approx(-360 * degree).epsilon(1e-13));
}

TEST_CASE("a control answer of an RMD motor and the 0x9C after it give one effort") {
    RmdMotor polled = motor();
    Frame control = status_answer();
    control.data[0] = 0xA1;
    for (int period = 0; period < 3; ++period) { // 0xA1, 0x92 and 0x9C
        CHECK_FALSE(polled.carries_no_values(control));
        CHECK(polled.decode(control).joint[0].effort_reason == Reason::ok);
        CHECK(polled.decode(frame_of(0x245, {0x92, 0, 0, 0, 1, 0, 0, 0})).kind == Kind::values);
        CHECK(polled.carries_no_values(status_answer()));
        CHECK(polled.decode(status_answer()).kind == Kind::nothing);
    }
    CHECK_FALSE(polled.carries_no_values(status_answer())); // no longer commanded
    CHECK(polled.decode(status_answer()).joint[0].effort_reason == Reason::ok);
    RmdMotor coarse = motor(RmdDriver::v3, RmdPosition::status);
    CHECK(coarse.decode(control).joint[0].position_reason == Reason::ok);
    CHECK(coarse.decode(status_answer()).kind == Kind::nothing);
}

TEST_CASE("a V2 driver's command with a direction gives no value and its answer does") {
    RmdMotor old = motor(RmdDriver::v2);
    for (const unsigned number : {0xA5U, 0xA6U}) {
        const auto byte = static_cast<std::uint8_t>(number);
        for (const std::uint8_t direction : {std::uint8_t{0}, std::uint8_t{1}}) {
            const Frame command = frame_of(0x145, {byte, direction, 0x32, 0, 0x50, 0x46, 0, 0});
            CHECK(old.decode(command).kind == Kind::nothing);
            CHECK(old.carries_no_values(command));
            CHECK(old.command(command) == MotorCommand::control);
        }
        const Frame answer = frame_of(0x145, {byte, 0x20, 0x64, 0, 0, 0, 0x50, 0x46});
        CHECK(old.decode(answer).joint[0].effort == Approx(100 * 33.0 / 2048).epsilon(1e-13));
        CHECK(old.command(answer) == MotorCommand::none);
    }
    const Frame cold = frame_of(0x145, {0xA1, 1, 0x64, 0, 0, 0, 0, 0}); // 1 °C; 0xA1 has no direction
    CHECK(old.decode(cold).kind == Kind::values);
}

const Frame zero_angle = frame_of(0x145, {0x92, 0, 0, 0, 0, 0, 0, 0}); ///< its request and its answer
const Frame status_request = frame_of(0x145, {0x9C, 0, 0, 0, 0, 0, 0, 0});
const Frame standing = frame_of(0x145, {0x9C, 0x20, 0x33, 0, 0, 0, 0, 0}, 7); ///< speed 0

/// Returns the value of the last of these frames to a V2 driver that has answered before.
JointValue last_of(std::initializer_list<Frame> frames) {
    RmdMotor old = motor(RmdDriver::v2);
    old.decode(standing);
    JointValue last;
    for (const Frame& frame : frames) {
        last = old.decode(frame).joint[0];
    }
    return last;
}

TEST_CASE("a V2 driver at rest at exactly 0 has a position if it answers") {
    const JointValue value = last_of({zero_angle, zero_angle, status_request, standing});
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == 0);
    CHECK(value.raw_zero);
    CHECK(value.stamp_ns == 7);
    CHECK(value.effort_reason == Reason::ok);
    Frame control = standing;
    control.data[0] = 0xA1;
    CHECK(last_of({control, zero_angle, zero_angle, status_request, standing}).position_reason == Reason::ok);
    const Frame errors = frame_of(0x145, {0x9A, 0x20, 0, 0, 0, 0, 0, 0}); // none
    CHECK(last_of({zero_angle, zero_angle, errors, status_request, standing}).position_reason == Reason::ok);
}

TEST_CASE("requests of a V2 driver's angle alone are not a position of 0") {
    const auto has_none = [](std::initializer_list<Frame> frames) {
        return last_of(frames).position_reason == Reason::waiting_for_position;
    };
    Frame moving = standing;
    moving.data[4] = 1;
    const Frame elsewhere = frame_of(0x145, {0x92, 1, 0, 0, 0, 0, 0, 0});
    CHECK(has_none({zero_angle, status_request, standing}));                         // a lost answer
    CHECK(has_none({zero_angle, zero_angle, zero_angle, status_request, standing})); // two programs
    CHECK(has_none({zero_angle, zero_angle, status_request, moving}));
    CHECK(has_none({zero_angle, zero_angle, elsewhere, status_request, standing}));
    CHECK(has_none({zero_angle, zero_angle, zero_angle, zero_angle})); // no motor
}

TEST_CASE("an answer of exactly 0 counts among the frames with values of a V2 driver that is heard") {
    RmdMotor old = motor(RmdDriver::v2);
    for (int i = 0; i < 4; ++i) { // not heard yet
        CHECK(old.carries_no_values(zero_angle));
        old.decode(zero_angle);
    }
    old.decode(standing);
    CHECK(old.carries_no_values(zero_angle)); // the request
    old.decode(zero_angle);
    CHECK_FALSE(old.carries_no_values(zero_angle));
    old.decode(zero_angle);
    CHECK(old.carries_no_values(zero_angle));
}

TEST_CASE("an RMD motor's errors invalidate its values until it reports none twice") {
    RmdMotor faulty = motor();
    CHECK(faulty.decode(frame_of(0x245, {0x9A, 0x32, 0, 1, 0xE5, 0x01, 0x02, 0x00})).reason ==
          Reason::device_fault); // 0x0002: stall
    CHECK(faulty.decode(status_answer()).joint[0].effort_reason == Reason::device_fault);
    CHECK(faulty.decode(frame_of(0x245, {0x92, 0, 0, 0, 1, 0, 0, 0})).joint[0].position_reason ==
          Reason::device_fault);
    const Frame none = frame_of(0x245, {0x9A, 0x32, 0, 1, 0xE5, 0x01, 0x00, 0x00});
    const Frame flipped = frame_of(0x245, {0x92 ^ 0x08, 0, 0, 0, 1, 0, 0, 0}); // a small angle
    CHECK(faulty.decode(flipped).reason == Reason::device_fault);
    CHECK(faulty.decode(status_answer()).joint[0].effort_reason == Reason::device_fault);
    CHECK(faulty.decode(none).reason == Reason::ok); // two agree
    CHECK(faulty.decode(status_answer()).joint[0].effort_reason == Reason::ok);
    RmdMotor old = motor(RmdDriver::v2);
    old.decode(frame_of(0x145, {0x9A, 0x32, 0, 0xE5, 0x01, 0, 0, 0x08}));
    CHECK(old.decode(status_answer(0x145)).joint[0].effort_reason == Reason::device_fault);
}

TEST_CASE("an RMD motor's answer with contradictory errors is rejected") {
    RmdMotor motor_v3 = motor();
    const Frame angle = frame_of(0x245, {0x92, 0, 0, 0, 0x18, 0xFC, 0xFF, 0xFF}); // -10 degrees
    Frame flipped = angle;
    flipped.data[0] ^= 0x08U; // 0x9A
    CHECK(motor_v3.decode(flipped).kind == Kind::rejected);
    CHECK(motor_v3.decode(angle).joint[0].position_reason == Reason::ok);
    RmdMotor old = motor(RmdDriver::v2);
    CHECK(old.decode(frame_of(0x145, {0x9A, 0x18, 0xFC, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF})).kind ==
          Kind::rejected);
    CHECK(old.decode(status_answer(0x145)).joint[0].effort_reason == Reason::ok);
}

TEST_CASE("other answers of an RMD motor give no values") {
    for (unsigned command = 0; command < 256; ++command) {
        const bool value =
            command == 0x92 || command == 0x9A || command == 0x9C || (command >= 0xA1 && command <= 0xA9);
        const Frame frame = frame_of(0x245, {static_cast<std::uint8_t>(command), 1, 2, 3, 4, 5, 6, 7});
        REQUIRE((motor().decode(frame).kind == Kind::nothing) != value);
    }
    CHECK(rejects_malformed(motor(), status_answer(), {8}));
}

TEST_CASE("a torque command to an RMD motor is a current") {
    const RmdMotor geared({.motor_id = 5, .joint = 4, .newton_metre_per_ampere = 2.5, .motor_per_joint = -1});
    const Frame command = geared.encode_torque(-5);
    CHECK(command.id == 0x145);
    CHECK(command.data[0] == 0xA1);
    CHECK(load_little<std::int16_t>(command.data.data() + 4) == 200); // 2 A
    CHECK(geared.decode_torque(command).value() == Approx(-5).epsilon(1e-12));
    CHECK(geared.command(command) == MotorCommand::control);
    CHECK(geared.command(frame_of(0x145, {0x9B, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::clear_faults);
    CHECK(geared.command(frame_of(0x145, {0x9C, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::poll);
    CHECK(geared.command(frame_of(0x145, {0x9A, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::read);
    CHECK(geared.command(frame_of(0x146, {0xA1, 0, 0, 0, 0, 0, 0, 0})) == MotorCommand::none);
}

TEST_CASE("a simulated RMD motor's answers are decoded to half a count with either driver") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-3, 3);
    for (const RmdDriver driver : {RmdDriver::v2, RmdDriver::v3}) {
        for (const RmdPosition position : {RmdPosition::multi_turn, RmdPosition::encoder}) {
            RmdMotor one = motor(driver, position);
            for (int i = 0; i < 200; ++i) {
                std::array<JointValue, 1> values{};
                values[0].position_rad = uniform(engine);
                values[0].effort = uniform(engine);
                const FrameList sent = one.encode(values);
                REQUIRE(sent.count == 2);
                const JointValue angle = one.decode(sent.frame[0]).joint[0];
                REQUIRE(std::abs(angle.position_rad - values[0].position_rad) < 0.501 * angle.step_rad);
                REQUIRE(std::abs(one.decode(sent.frame[1]).joint[0].effort - values[0].effort) < 0.0081);
            }
        }
    }
}

} // namespace rmd_test
