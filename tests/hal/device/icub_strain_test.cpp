// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_strain.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace icub_strain_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using icub::StrainBoard;
using Kind = Decoded::Kind;

/// Full scales of an FT45 as reported by the left arm's board: 1500 1500 2000 N, 35 35 25 N·m.
StrainBoard left_arm_board() {
    StrainBoard board(0x0D);
    board.decode(frame_of(0x2D0, {0x18, 0x00, 0x05, 0xDC}));
    board.decode(frame_of(0x2D0, {0x18, 0x01, 0x05, 0xDC}));
    board.decode(frame_of(0x2D0, {0x18, 0x02, 0x07, 0xD0}));
    board.decode(frame_of(0x2D0, {0x18, 0x03, 0x00, 0x23}));
    board.decode(frame_of(0x2D0, {0x18, 0x04, 0x00, 0x23}));
    board.decode(frame_of(0x2D0, {0x18, 0x05, 0x00, 0x19}));
    return board;
}

const Frame some_force = frame_of(0x3DA, {0x00, 0xC0, 0xFF, 0x7F, 0x01, 0x80});  // 0xC000 0x7FFF 0x8001
const Frame some_torque = frame_of(0x3DB, {0x00, 0x00, 0x00, 0x80, 0xFF, 0xFF}); // 0 0x8000 0xFFFF

TEST_CASE("a strain board's two frames are force and torque in offset binary relative to the full scale") {
    StrainBoard board = left_arm_board();
    CHECK(board.decode(some_force).kind == Kind::part);
    CHECK(board.decode(some_force).part == 0);
    CHECK(board.decode(some_torque).part == 1);
    const WrenchReading reading = board.wrench(some_force, some_torque);
    CHECK(reading.reason == Reason::ok);
    CHECK(reading.raw == std::array<std::int32_t, 6>{0x4000, -1, 1, -0x8000, 0, 0x7FFF});
    CHECK(reading.value[0] == Approx(750));
    CHECK(reading.value[1] == Approx(-1500.0 / 32768));
    CHECK(reading.value[2] == Approx(2000.0 / 32768));
    CHECK(reading.value[3] == Approx(-35));
    CHECK(reading.value[4] == 0);
    CHECK(reading.value[5] == Approx(25 * 32767.0 / 32768));
}

TEST_CASE("a seventh byte in either frame of a strain board means that the wrench is the last good one") {
    const StrainBoard board = left_arm_board();
    Frame saturated = with_length(some_force, 7);
    saturated.data[6] = 0x0A;
    CHECK(board.wrench(saturated, some_torque).reason == Reason::output_saturated);
    CHECK(board.wrench(some_force, with_length(some_torque, 7)).reason == Reason::output_saturated);
}

TEST_CASE("a strain board gives no wrench before all six full scales are known and plausible") {
    StrainBoard board(0x0D);
    for (int channel = 0; channel < 6; ++channel) {
        CHECK(board.wrench(some_force, some_torque).reason == Reason::waiting_for_full_scale);
        const auto number = static_cast<std::uint8_t>(channel);
        CHECK(board.decode(frame_of(0x2D0, {0x18, number, 0x00, 0xC8})).kind == Kind::status);
    }
    CHECK(board.wrench(some_force, some_torque).reason == Reason::ok);
    CHECK(board.wrench(some_force, some_torque).value[3] == Approx(-200)); // 0x00C8, not 0xC800
    // 0; the firmware's default; 0xDC05, with bytes swapped by a gateway
    for (const auto& [high, low] : {std::pair{0x00, 0x00}, {0x7F, 0xFF}, {0xDC, 0x05}}) {
        board.decode(
            frame_of(0x2D0, {0x18, 0x02, static_cast<std::uint8_t>(high), static_cast<std::uint8_t>(low)}));
        CHECK(board.wrench(some_force, some_torque).reason == Reason::full_scale_implausible);
    }
    CHECK(board.full_scale().changed() == 3);
}

TEST_CASE("a reply about another calibration set of a strain board is counted and changes nothing") {
    StrainBoard board = left_arm_board();
    for (std::uint8_t channel = 0; channel < 6; ++channel) {
        const auto of_set_two = static_cast<std::uint8_t>(0x20 | channel);
        board.decode(frame_of(0x2D0, {0x18, of_set_two, 0x01, 0xF4}));
    }
    CHECK(board.wrench(some_force, some_torque).reason == Reason::ok);
    CHECK(board.wrench(some_force, some_torque).value[0] == Approx(750));
    CHECK(board.other_sets() == 6);
    CHECK(board.last_other_set() == 2);
    StrainBoard fresh(0x0D); // it does not set an unknown full scale either
    for (int channel = 0; channel < 6; ++channel) {
        fresh.decode(fresh.encode_full_scale(channel, 500, 1));
    }
    CHECK(fresh.full_scale().reason() == Reason::waiting_for_full_scale);
    fresh.use_calibration_set(1);
    for (int channel = 0; channel < 6; ++channel) {
        fresh.decode(fresh.encode_full_scale(channel, 500, 1));
    }
    CHECK(fresh.full_scale().reason() == Reason::ok);
}

TEST_CASE("a reply with the same full scale for another set is not counted as different") {
    StrainBoard board = left_arm_board();
    board.decode(board.encode_full_scale(3, 35, 1));
    CHECK(board.other_sets() == 0);
}

TEST_CASE("a strain board that contradicts its description gives no wrench until it agrees") {
    StrainBoard board(0x0D);
    const double described[] = {1500, 1500, 2000, 35, 35, 25};
    for (int channel = 0; channel < 6; ++channel) {
        board.describe_full_scale(channel, described[channel]);
    }
    CHECK(board.wrench(some_force, some_torque).reason == Reason::ok);
    board.decode(board.encode_full_scale(0, 500));
    CHECK(board.wrench(some_force, some_torque).reason == Reason::full_scale_contradicted);
    board.decode(board.encode_full_scale(1, 1500));
    CHECK(board.wrench(some_force, some_torque).reason == Reason::full_scale_contradicted);
    board.decode(board.encode_full_scale(0, 1500));
    CHECK(board.wrench(some_force, some_torque).reason == Reason::ok);
    CHECK(board.wrench(some_force, some_torque).value[0] == Approx(750));
}

TEST_CASE("a strain board's full scale is requested and its other replies are ignored") {
    const Frame request = left_arm_board().request_full_scale(4);
    CHECK(request.id == 0x20D);
    CHECK(request.length == 2);
    CHECK(request.data[0] == 0x18);
    CHECK(request.data[1] == 4);
    StrainBoard board(0x0D);
    CHECK(board.decode(frame_of(0x2D0, {0x1C, 1, 2, 3, 4, 5, 6})).kind == Kind::nothing);
    CHECK(board.decode(frame_of(0x2D0, {})).kind == Kind::nothing);
    CHECK(board.decode(frame_of(0x2D0, {0x18, 9, 2, 3})).kind == Kind::status); // no such channel
    CHECK(board.full_scale().reason() == Reason::waiting_for_full_scale);
}

TEST_CASE("a strain board's frames have fixed lengths") {
    CHECK(rejects_malformed(left_arm_board(), some_force, {6, 7}));
    CHECK(rejects_malformed(left_arm_board(), some_torque, {6, 7}));
    StrainBoard board = left_arm_board();
    CHECK(board.decode(frame_of(0x2D0, {0x18, 0, 1})).reason == Reason::wrong_length);
    CHECK(board.decode(frame_of(0x2D0, {0x18, 0, 1, 2, 3})).reason == Reason::wrong_length);
    for (const std::uint32_t id : {0x3D8U, 0x3D9U, 0x3DEU, 0x3CAU, 0x2C0U, 0x20DU, 0x1DAU}) {
        CHECK(board.decode(frame_of(id, {0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
        CHECK_FALSE(board.claims(id));
    }
}

TEST_CASE("a simulated strain board's wrench is decoded to within half a step or is saturated") {
    DFDYN_SEEDED_ENGINE(engine);
    StrainBoard board = left_arm_board();
    const Wrench full_scale{1500, 1500, 2000, 35, 35, 25};
    std::uniform_real_distribution<double> share(-0.9999, 0.9999);
    for (int i = 0; i < 1000; ++i) {
        Wrench value{};
        for (std::size_t k = 0; k < 6; ++k) {
            value[k] = share(engine) * full_scale[k];
        }
        const FrameList sent = board.encode(value);
        REQUIRE(sent.count == 2);
        const WrenchReading reading = board.wrench(sent.frame[0], sent.frame[1]);
        REQUIRE(reading.reason == Reason::ok);
        for (std::size_t k = 0; k < 6; ++k) {
            REQUIRE(std::abs(reading.value[k] - value[k]) <= 0.5001 * full_scale[k] / 32768);
        }
    }
    const FrameList overload = board.encode({0, 1600, 0, 0, 0, 0});
    CHECK(overload.frame[0].length == 7);
    CHECK(overload.frame[1].length == 7);
    CHECK(board.wrench(overload.frame[0], overload.frame[1]).reason == Reason::output_saturated);
    StrainBoard asking(0x0D);
    asking.decode(board.encode_full_scale(0, 1500));
    CHECK(asking.full_scale()[0] == 1500);
}

} // namespace icub_strain_test
