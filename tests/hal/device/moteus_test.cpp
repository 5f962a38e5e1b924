// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/moteus.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace moteus_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;
using Bytes = std::vector<std::uint8_t>;

constexpr double turn = 2 * 3.14159265358979323846;
constexpr double degree = turn / 360;

Bytes bytes_of(const std::string& hex) {
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    }
    return bytes;
}

/// Returns a CAN FD frame, padded with 0x50 to a valid length.
Frame flexible(std::uint32_t id, Bytes bytes) {
    while (!is_frame_length(static_cast<std::uint32_t>(bytes.size()), true)) {
        bytes.push_back(0x50);
    }
    Frame frame = make_frame(id, static_cast<int>(bytes.size()));
    frame.extended = id > 0x7FF;
    frame.fd = frame.bit_rate_switch = true;
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    return frame;
}
Frame reply(const std::string& hex) { return flexible(0x100, bytes_of(hex)); }

MoteusController controller() { return MoteusController({.id = 1, .joint = 2}); }
JointValue value_of(const std::string& hex) { return controller().decode(reply(hex)).joint[0]; }

TEST_CASE("the reply of the moteus documentation is decoded as it says") {
    const Frame frame = reply("2404000a005000000170ff230d181400");
    REQUIRE(frame.length == 16);
    const Decoded decoded = controller().decode(frame);
    REQUIRE(decoded.kind == Kind::values);
    const JointValue& value = decoded.joint[0];
    CHECK(value.joint == 2);
    CHECK(value.position_reason == Reason::ok); // mode 10, no fault
    CHECK(value.position_rad == Approx(2.88 * degree).epsilon(1e-12));
    CHECK(value.has_velocity);
    CHECK(value.velocity == Approx(23.04 * degree).epsilon(1e-12));
    CHECK(value.effort_reason == Reason::ok);
    CHECK(value.effort == Approx(-1.44).epsilon(1e-12));
    CHECK(value.step_rad == Approx(1e-4 * turn).epsilon(1e-12));
}

TEST_CASE("the command of the moteus documentation is a command and its stiffness makes it no torque") {
    const Frame command = flexible(0x8001, bytes_of("01000a07206000200150ff140400130d"));
    CHECK(controller().decode(command).kind == Kind::nothing);
    CHECK(controller().command(command) == MotorCommand::control);
    CHECK(controller().concerns(command));
    CHECK_FALSE(controller().decode_torque(command));
}

TEST_CASE("moteus registers are decoded in any order and type") {
    // torque, then velocity, as float; position as int32; mode as int8; padding between them
    const JointValue mixed = value_of("2d030000c03f50" // 1.5 N·m
                                      "2d020000003f"   // 0.5 turns/s
                                      "2901a0860100"   // 100000: 1 turn
                                      "5021000a");
    CHECK(mixed.position_rad == Approx(turn).epsilon(1e-12));
    CHECK(mixed.velocity == Approx(0.5 * turn).epsilon(1e-12));
    CHECK(mixed.effort == Approx(1.5));
    // int8: 50 is half a turn, 5 is half a turn/s, 3 is 1.5 N·m
    const JointValue coarse = value_of("2301320503");
    CHECK(coarse.position_rad == Approx(0.5 * turn).epsilon(1e-12));
    CHECK(coarse.velocity == Approx(0.5 * turn).epsilon(1e-12));
    CHECK(coarse.effort == Approx(1.5));
    CHECK(coarse.step_rad == Approx(0.01 * turn).epsilon(1e-12));
    // int16 counts: 2.5e-4 turns/s, 0.01 N·m
    const JointValue fine = value_of("2701"
                                     "8813"
                                     "d007"
                                     "9600");
    CHECK(fine.position_rad == Approx(0.5 * turn).epsilon(1e-12));
    CHECK(fine.velocity == Approx(0.5 * turn).epsilon(1e-12));
    CHECK(fine.effort == Approx(1.5));
    // the number of registers as a varuint, in one byte and in two
    CHECK(value_of("2803"
                   "01"
                   "a0860100"
                   "50c30000"
                   "dc050000")
              .effort == Approx(1.5));
    CHECK(value_of("288300"
                   "01"
                   "a0860100"
                   "50c30000"
                   "dc050000")
              .effort == Approx(1.5));
}

TEST_CASE("a moteus value of NaN or the most negative integer is invalid") {
    for (const char* const hex : {"210180",
                                  "250100"
                                  "80",
                                  "2901"
                                  "00000080",
                                  "2d01"
                                  "0000c07f",
                                  "2d01"
                                  "0000807f"}) {
        CHECK(value_of(hex).position_reason == Reason::position_out_of_range);
    }
    for (const char* const hex : {"210380",
                                  "250300"
                                  "80",
                                  "2903"
                                  "00000080",
                                  "2d03"
                                  "0000c07f"}) {
        CHECK(value_of(hex).effort_reason == Reason::output_out_of_range);
    }
    CHECK(value_of("21017f").position_reason == Reason::position_out_of_range); // the other end: saturated
    CHECK_FALSE(value_of("2d02"
                         "0000c07f")
                    .has_velocity);
}

/// Returns the values of the third reply of its layout, which is always accepted.
Decoded third_reply(MoteusController& device, const Frame& frame) {
    device.decode(frame);
    device.decode(frame);
    return device.decode(frame);
}

TEST_CASE("a moteus value is valid in operating modes without a fault") {
    for (unsigned mode = 0; mode < 256; ++mode) {
        MoteusController device = controller();
        device.decode(flexible(0x100, {0x21, 0x00, static_cast<std::uint8_t>(mode)}));
        const Reason reason = third_reply(device, reply("2d010000003f")).joint[0].position_reason;
        const bool operates = (mode >= 5 && mode <= 10) || mode == 12 || mode == 13;
        const bool known = mode <= 15 && mode != 1;
        CAPTURE(mode);
        CHECK(reason == (operates ? Reason::ok
                         : known  ? Reason::device_not_operational
                                  : Reason::device_fault));
    }
    for (unsigned fault = 0; fault < 128; ++fault) { // from 96 on, limits that are active
        MoteusController device = controller();
        device.decode(flexible(0x100, {0x21, 0x0F, static_cast<std::uint8_t>(fault)}));
        const Reason reason = third_reply(device, reply("2d010000003f")).joint[0].position_reason;
        CAPTURE(fault);
        CHECK(reason == (fault > 0 && fault < 96 ? Reason::device_fault : Reason::ok));
    }
}

TEST_CASE("error sub-frames, channels and padding of a moteus reply are skipped") {
    CHECK(value_of("30208001"
                   "2d010000003f")
              .position_rad == Approx(0.5 * turn)); // write error
    CHECK(value_of("310f07"
                   "2d010000003f")
              .position_rad == Approx(0.5 * turn)); // read error
    CHECK(value_of("50505050"
                   "2d010000003f")
              .position_rad == Approx(0.5 * turn));
    CHECK(value_of("4101030a0b0c"
                   "2d010000003f")
              .position_rad == Approx(0.5 * turn)); // three bytes of channel 1
    CHECK(controller().decode(reply("310f07")).kind == Kind::nothing);
    CHECK(controller().decode(reply("50505050")).kind == Kind::nothing);
}

TEST_CASE("malformed moteus replies are rejected as a whole") {
    for (const char* const hex : {"2d0100", "24", "2404000a0050", "28ffffffff7f01", "4101ff0a", "30"}) {
        const Bytes bytes = bytes_of(hex);
        Frame frame = flexible(0x100, bytes);
        frame.length = static_cast<std::uint8_t>(bytes.size());
        CAPTURE(hex);
        CHECK(controller().decode(frame).kind == Kind::rejected);
        CHECK(controller().decode(frame).reason == Reason::wrong_length);
    }
    for (const char* const hex : {"ff", "60", "0f0100", "1401"}) { // unknown, a write, a read
        CHECK(controller().decode(reply(hex)).kind == Kind::rejected);
    }
}

TEST_CASE("moteus replies to another host or from another controller are ignored") {
    const Bytes bytes = bytes_of("2d010000003f");
    CHECK(controller().decode(flexible(0x102, bytes)).kind == Kind::nothing);
    CHECK(MoteusController::is_reply_to_other({.id = 1}, flexible(0x102, bytes)));
    CHECK_FALSE(MoteusController::is_reply_to_other({.id = 1}, flexible(0x100, bytes)));
    CHECK_FALSE(MoteusController::is_reply_to_other({.id = 1}, flexible(0x202, bytes)));
    CHECK(controller().decode(flexible(0x200, bytes)).kind == Kind::nothing);
    CHECK(MoteusController({.id = 12}).decode(flexible(0xC00, bytes)).kind == Kind::values);
    Frame wide = flexible(0x100, bytes); // either format of the identifier
    wide.extended = true;
    CHECK(controller().decode(wide).kind == Kind::values);
    Frame classic = frame_of(0x100, {0x2D, 0x01, 0, 0, 0, 0x3F});
    CHECK(controller().decode(classic).reason == Reason::wrong_frame_type);
}

TEST_CASE("a torque command to a moteus has no stiffness and damping and requests a reply") {
    const MoteusController device({.id = 3, .joint = 0, .motor_per_joint = -2});
    const Frame command = device.encode_torque(4);
    CHECK(command.id == 0x8003);
    CHECK(command.extended);
    CHECK(command.fd);
    CHECK(is_well_formed(command));
    const Bytes start(command.data.begin(), command.data.begin() + 9);
    CHECK(start ==
          Bytes{0x01, 0x00, 0x0A, 0x02, 0x20, 0x80, 0x80, 0x0D, 0x22}); // position and velocity: no value
    CHECK(load_little<float>(command.data.data() + 9) == -2.0F);
    CHECK(device.decode_torque(command).value() == Approx(4));
    Frame stiff = command;
    stiff.data[15] = 1; // of kp
    CHECK_FALSE(device.decode_torque(stiff));
    CHECK(device.command(flexible(0x8003, bytes_of("010000"))) == MotorCommand::clear_faults); // mode stopped
    CHECK(device.command(flexible(0x8003, bytes_of("1404001100"))) == MotorCommand::poll);
    CHECK_FALSE(device.decode_torque(flexible(0x8003, bytes_of("1404001100"))));
    CHECK(device.command(flexible(0x8004, bytes_of("010000"))) == MotorCommand::none);
}

TEST_CASE("a reply to a host with the number of a moteus controller is no command to the controller") {
    const MoteusController third({.id = 3, .joint = 0});
    for (const char* const hex : {"2404000a005000000170ff230d181400", // the example of the documentation
                                  "2F01000000000000003F00000000", "5021000A", "300104", "41010100"}) {
        const Frame frame = flexible(0x0103, bytes_of(hex)); // of controller 1 to host 3
        CHECK(third.command(frame) == MotorCommand::none);
        CHECK_FALSE(third.decode_torque(frame));
    }
    CHECK(third.command(flexible(0x0103, bytes_of("1404001100"))) == MotorCommand::poll);
    CHECK(third.command(flexible(0x8103, bytes_of("400100"))) == MotorCommand::poll); // data of a channel
}

TEST_CASE("a flipped bit in a moteus sub-frame's header gives no value of a wrong register") {
    constexpr double torque = 0.25;
    std::array<JointValue, 1> values{};
    values[0].position_rad = 1.5;
    values[0].effort = torque;
    const Frame sound = MoteusController({.id = 3, .joint = 0}).encode(values).frame[0];
    for (const std::size_t byte : {0U, 1U, 3U, 4U, 17U, 18U}) {
        for (unsigned bit = 0; bit < 8; ++bit) {
            CAPTURE(byte, bit);
            MoteusController device({.id = 3, .joint = 0});
            REQUIRE(device.decode(sound).joint[0].effort == Approx(torque));
            Frame flipped = sound;
            flipped.data[byte] = static_cast<std::uint8_t>(flipped.data[byte] ^ (1U << bit));
            const Decoded decoded = device.decode(flipped);
            const JointValue& value = decoded.joint[0];
            const bool values_come = decoded.kind == Kind::values;
            const bool effort = values_come && value.effort_reason == Reason::ok;
            const bool position = values_come && value.position_reason == Reason::ok;
            CHECK((!effort || value.effort == Approx(torque)));
            CHECK((!position || value.position_rad == Approx(1.5)));
            CHECK(device.decode(sound).joint[0].position_reason == Reason::ok);
        }
    }
}

TEST_CASE("a changed layout of moteus replies is accepted from the third reply on") {
    MoteusController device = controller();
    const Frame before = reply("2d01000080be2d030000003f"); // position and torque as float
    const Frame after = reply("2c0300000000003f");          // a new layout
    REQUIRE(device.decode(before).kind == Kind::values);
    const Frame other = reply("250110002503e803"); // as int16
    CHECK(device.decode(other).kind == Kind::rejected);
    CHECK(device.decode(before).kind == Kind::values);
    CHECK(device.decode(other).kind == Kind::rejected);
    const Decoded third = device.decode(other);
    REQUIRE(third.kind == Kind::values);
    CHECK(third.joint[0].effort == Approx(10));
    CHECK(device.decode(after).kind != Kind::values);
    CHECK(device.decode(before).kind == Kind::values);
}

/// A reply with position and torque as float, and one more register as int8.
Frame polled(unsigned reg) {
    Bytes bytes = bytes_of("2d01000080be2d030000003f20010000");
    bytes[13] = 0x01; // one register
    bytes[14] = static_cast<std::uint8_t>(reg);
    return flexible(0x100, bytes);
}

TEST_CASE("polling one more moteus register in turn loses no values after the first rounds") {
    const std::array<unsigned, 12> other{0x04, 0x05, 0x06, 0x07, 0x0A, 0x0D,
                                         0x0E, 0x10, 0x20, 0x21, 0x22, 0x30};
    const std::array<unsigned, 12> state{0x00, 0x02, 0x0E, 0x0F, 0x04, 0x05,
                                         0x06, 0x07, 0x0A, 0x0D, 0x10, 0x20};
    for (const auto& registers : {other, state}) {
        MoteusController device = controller();
        for (int round = 0; round < 100; ++round) {
            for (const unsigned reg : registers) {
                CAPTURE(round, reg);
                const bool values = device.decode(polled(reg)).kind == Kind::values;
                CHECK((values || (round < 2 && registers == state)));
            }
        }
    }
}

TEST_CASE("eight alternating layouts of moteus replies are all accepted after two rounds") {
    const std::array<const char*, 8> layouts{"2d01000080be", "2d030000003f",      "25010010",
                                             "25030010",     "250100102503e803",  "2901001000002503e803",
                                             "2101102103e8", "2d01000080be2103e8"};
    MoteusController device = controller();
    for (int round = 0; round < 50; ++round) {
        for (const char* const hex : layouts) {
            CAPTURE(round, hex);
            CHECK((device.decode(reply(hex)).kind != Kind::rejected || round < 2));
        }
    }
}

TEST_CASE("a flipped bit does not turn a moteus' temperature into a fault") {
    MoteusController device = controller();
    REQUIRE(device.decode(reply("2d01000080be")).joint[0].position_reason == Reason::ok);
    device.decode(reply("210e2850"));                               // 40 degrees
    CHECK(device.decode(reply("210f2850")).kind == Kind::rejected); // as the number of a fault
    CHECK(device.decode(reply("2d01000080be")).joint[0].position_reason == Reason::ok);
}

TEST_CASE("a simulated moteus' reply is decoded to the resolution of a float") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> uniform(-3, 3);
    MoteusController device({.id = 3, .joint = 0, .motor_per_joint = -2, .zero_rad = 0.5});
    for (int i = 0; i < 300; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = uniform(engine);
        values[0].effort = uniform(engine);
        values[0].has_velocity = true;
        values[0].velocity = uniform(engine);
        const Frame frame = device.encode(values).frame[0];
        REQUIRE(is_well_formed(frame));
        const JointValue seen = device.decode(frame).joint[0];
        REQUIRE(seen.position_reason == Reason::ok);
        REQUIRE(seen.position_rad == Approx(values[0].position_rad).margin(1e-6));
        REQUIRE(seen.velocity == Approx(values[0].velocity).margin(1e-6));
        REQUIRE(seen.effort == Approx(values[0].effort).margin(1e-6));
    }
}

} // namespace moteus_test
