// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/robotous_rft.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace robotous_rft_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Kind = Decoded::Kind;

RobotousRft small_sensor() { return RobotousRft({0xF9, 0xFA, 50, 2000}); }

// Fx 0x1234, Fy -1, Fz 0x7FFF; Tx 0xFE0C over both frames, Ty 2000, Tz -32768
const Frame first_frame = frame_of(0xF9, {0x0B, 0x12, 0x34, 0xFF, 0xFF, 0x7F, 0xFF, 0xFE});
const Frame second_frame = frame_of(0xFA, {0x0C, 0x07, 0xD0, 0x80, 0x00, 0x00, 0x00, 0x00});

TEST_CASE("a Robotous sensor's record is split in the middle of Tx") {
    const RobotousRft sensor = small_sensor();
    CHECK(sensor.decode(first_frame).part == 0);
    CHECK(sensor.decode(second_frame).part == 1);
    const WrenchReading reading = sensor.wrench(first_frame, second_frame);
    CHECK(reading.reason == Reason::ok);
    CHECK(reading.raw == std::array<std::int32_t, 6>{0x1234, -1, 32767, -500, 2000, -32768});
    CHECK(reading.value[0] == Approx(93.2));
    CHECK(reading.value[3] == Approx(-0.25));
    CHECK(reading.value[4] == Approx(1));
}

TEST_CASE("any overload bit of a Robotous sensor rejects the whole wrench") {
    for (int bit = 0; bit < 8; ++bit) {
        Frame second = second_frame;
        second.data[5] = static_cast<std::uint8_t>(1 << bit);
        const Reason expected = bit < 6 ? Reason::output_saturated : Reason::ok;
        CHECK(small_sensor().wrench(first_frame, second).reason == expected);
    }
}

TEST_CASE("a Robotous sensor's other replies are ignored and its frames have eight bytes") {
    Frame reply = first_frame;
    reply.data[0] = 0x10;
    CHECK(small_sensor().decode(reply).kind == Kind::nothing);
    CHECK(rejects_malformed(small_sensor(), first_frame, {8}));
    CHECK(rejects_malformed(small_sensor(), second_frame, {8}));
    CHECK(small_sensor().decode(frame_of(0xF8, {0x0B, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
    const Frame start = RobotousRft::start(0xF8);
    CHECK(start.id == 0xF8);
    CHECK(start.length == 8);
    CHECK(start.data[0] == 0x0B);
}

TEST_CASE("a simulated Robotous sensor's wrench is decoded to within half a step or is overloaded") {
    DFDYN_SEEDED_ENGINE(engine);
    const RobotousRft sensor = small_sensor();
    std::uniform_real_distribution<double> share(-0.99, 0.99);
    for (int i = 0; i < 1000; ++i) {
        Wrench value{};
        for (std::size_t k = 0; k < 6; ++k) {
            value[k] = share(engine) * (k < 3 ? 655 : 16);
        }
        const FrameList sent = sensor.encode(value);
        const WrenchReading reading = sensor.wrench(sent.frame[0], sent.frame[1]);
        REQUIRE(reading.reason == Reason::ok);
        for (std::size_t k = 0; k < 6; ++k) {
            REQUIRE(std::abs(reading.value[k] - value[k]) <= 0.50001 / (k < 3 ? 50 : 2000));
        }
    }
    const FrameList overload = sensor.encode({0, 0, -700, 0, 0, 0});
    CHECK(overload.frame[1].data[5] == 0x08); // Fx is bit 5, Fz bit 3
    CHECK(sensor.wrench(overload.frame[0], overload.frame[1]).reason == Reason::output_saturated);
}

} // namespace robotous_rft_test
