// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_two_joint_board.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace icub_two_joint_board_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using icub::TwoJointBoard;
using Kind = Decoded::Kind;

constexpr double degree = std::numbers::pi / 180;

/// Board 3 of an iCub's arm: -11.375 ticks per degree; joints 2 and 3.
TwoJointBoard arm_board() { return {3, {2, -11.375, 10}, {3, 8, 0}}; }

TEST_CASE("an iCub board's POSITION contains the ticks of two joints") {
    TwoJointBoard board = arm_board();
    // -1024 ticks: 1024 / 11.375 - 10 deg; 0x01020304 ticks
    const Decoded decoded =
        board.decode(frame_of(0x131, {0x00, 0xFC, 0xFF, 0xFF, 0x04, 0x03, 0x02, 0x01}, 77));
    REQUIRE(decoded.kind == Kind::values);
    REQUIRE(decoded.joints == 2);
    CHECK(decoded.joint[0].joint == 2);
    CHECK(decoded.joint[1].joint == 3);
    for (const JointValue& value : decoded.joint) {
        CHECK(value.stamp_ns == 77);
        CHECK(value.position_reason == Reason::ok);
        CHECK(value.effort_reason == Reason::no_output);
        CHECK_FALSE(value.raw_zero);
    }
    CHECK(decoded.joint[0].position_rad == Approx((1024 / 11.375 - 10) * degree).epsilon(1e-14));
    CHECK(decoded.joint[1].position_rad == Approx(16909060 / 8.0 * degree).epsilon(1e-14));
    CHECK(board.decode(frame_of(0x131, {0, 0, 0, 0, 1, 0, 0, 0})).joint[0].raw_zero);
}

TEST_CASE("positions of an iCub board are rejected while its STATUS reports an encoder error") {
    TwoJointBoard board = arm_board();
    const Frame position = frame_of(0x131, {1, 0, 0, 0, 1, 0, 0, 0});
    CHECK(board.decode(frame_of(0x133, {0x20, 0, 0, 0, 0, 0, 0, 0})).reason == Reason::encoder_fault);
    CHECK(board.decode(position).joint[0].position_reason == Reason::encoder_fault);
    CHECK(board.decode(position).joint[1].position_reason == Reason::ok);
    CHECK(board.decode(frame_of(0x133, {0, 0, 0x40, 0, 0, 0, 0, 0})).kind == Kind::status);
    CHECK(board.decode(position).joint[0].position_reason == Reason::ok);
    CHECK(board.decode(position).joint[1].position_reason == Reason::encoder_fault);
    // Flags from undervoltage to hall sensor, modes and the board's own flags do not concern the encoder.
    CHECK(board.decode(frame_of(0x133, {0x1F, 0xFF, 0x1F, 0xFF, 0xFF, 0xFF, 9, 9})).reason == Reason::ok);
    CHECK(board.decode(position).joint[1].position_reason == Reason::ok);
}

TEST_CASE("an iCub board's report of lost messages is decoded") {
    CHECK(arm_board().decode(frame_of(0x135, {})).kind == Kind::lost);
}

TEST_CASE("frames of other boards and other messages are ignored by an iCub board") {
    for (const std::uint32_t id : {0x121U, 0x130U, 0x132U, 0x137U, 0x13AU, 0x231U, 0x331U, 0x003U}) {
        CHECK(arm_board().decode(frame_of(id, {0, 0, 0, 0, 0, 0, 0, 0})).kind == Kind::nothing);
        CHECK_FALSE(arm_board().claims(id));
    }
    for (const std::uint32_t id : {0x131U, 0x133U, 0x135U}) {
        CHECK(arm_board().claims(id));
    }
}

TEST_CASE("an iCub board's frames have exactly eight bytes") {
    CHECK(rejects_malformed(arm_board(), frame_of(0x131, {1, 2, 3, 4, 5, 6, 7, 8}), {8}));
    CHECK(rejects_malformed(arm_board(), frame_of(0x133, {1, 2, 3, 4, 5, 6, 7, 8}), {8}));
}

TEST_CASE("a simulated iCub board's positions are decoded to within half a tick") {
    DFDYN_SEEDED_ENGINE(engine);
    TwoJointBoard board = arm_board();
    std::uniform_real_distribution<double> angle(-3, 3);
    for (int i = 0; i < 1000; ++i) {
        std::array<JointValue, 2> values{};
        values[0].position_rad = angle(engine);
        values[1].position_rad = angle(engine);
        const FrameList sent = board.encode(values);
        REQUIRE(sent.count == 1);
        const Decoded decoded = board.decode(sent.frame[0]);
        REQUIRE(std::abs(decoded.joint[0].position_rad - values[0].position_rad) <= 0.5001 / 11.375 * degree);
        REQUIRE(std::abs(decoded.joint[1].position_rad - values[1].position_rad) <= 0.5001 / 8 * degree);
    }
    CHECK(board.decode(board.encode_status(0, TwoJointBoard::optical_encoder_error)).reason ==
          Reason::encoder_fault);
}

} // namespace icub_two_joint_board_test
