// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/icub_2foc.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace icub_2foc_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using icub::FocBoard;
using Kind = Decoded::Kind;

FocBoard knee() { return FocBoard({.address = 2, .joint = 1, .motor_per_joint = -100, .zero_rad = 0.5}); }

TEST_CASE("a 2FOC board's current and velocity and position are decoded") {
    FocBoard board = knee();
    // -1500 mA, velocity 7, a quarter turn (0x4000)
    const Decoded decoded =
        board.decode(frame_of(0x120, {0x24, 0xFA, 0x07, 0x00, 0x00, 0x40, 0x00, 0x00}, 9));
    REQUIRE(decoded.kind == Kind::values);
    REQUIRE(decoded.joints == 1);
    const JointValue& value = decoded.joint[0];
    CHECK(value.joint == 1);
    CHECK(value.stamp_ns == 9);
    CHECK(value.position_reason == Reason::ok);
    CHECK(value.position_rad == Approx(0.5 - std::numbers::pi / 200).epsilon(1e-14));
    CHECK(value.effort_reason == Reason::ok);
    CHECK(value.effort == Approx(-1.5));
}

TEST_CASE("a 2FOC board's faults reject the values that they affect") {
    FocBoard board = knee();
    const Frame motion = frame_of(0x120, {1, 0, 0, 0, 1, 0, 0, 0});
    CHECK(board.decode(frame_of(0x123, {0, 0x04, 0, 0, 0, 0, 0, 0})).reason == Reason::encoder_fault);
    CHECK(board.decode(motion).joint[0].position_reason == Reason::encoder_fault);
    CHECK(board.decode(motion).joint[0].effort_reason == Reason::ok);
    CHECK(board.decode(frame_of(0x123, {5, 0, 9, 9, 0, 0, 0x80, 0})).reason == Reason::device_fault);
    CHECK(board.decode(motion).joint[0].position_reason == Reason::ok);
    CHECK(board.decode(motion).joint[0].effort_reason == Reason::device_fault);
    CHECK(board.decode(frame_of(0x123, {5, 0, 9, 9, 0, 0, 0, 0})).reason == Reason::ok);
    CHECK(board.decode(motion).joint[0].effort_reason == Reason::ok);
}

TEST_CASE("a 2FOC board's frames have exactly eight bytes") {
    CHECK(rejects_malformed(knee(), frame_of(0x120, {1, 2, 3, 4, 5, 6, 7, 8}), {8}));
    CHECK(rejects_malformed(knee(), frame_of(0x123, {1, 2, 3, 4, 5, 6, 7, 8}), {8}));
    CHECK(knee().decode(frame_of(0x121, {1, 2, 3, 4, 5, 6, 7, 8})).kind == Kind::nothing);
}

TEST_CASE("a simulated 2FOC board's values are decoded to within half a step") {
    DFDYN_SEEDED_ENGINE(engine);
    FocBoard board = knee();
    std::uniform_real_distribution<double> angle(-3, 3);
    std::uniform_real_distribution<double> current(-32, 32);
    for (int i = 0; i < 1000; ++i) {
        std::array<JointValue, 1> values{};
        values[0].position_rad = angle(engine);
        values[0].effort = current(engine);
        const Decoded decoded = board.decode(board.encode(values).frame[0]);
        const double step = 2 * std::numbers::pi / 65536 / 100;
        REQUIRE(std::abs(decoded.joint[0].position_rad - values[0].position_rad) <= 0.5001 * step);
        REQUIRE(std::abs(decoded.joint[0].effort - values[0].effort) <= 0.50001e-3);
    }
    std::array<JointValue, 1> strong{};
    strong[0].effort = 100;
    CHECK(board.decode(board.encode(strong).frame[0]).joint[0].effort == Approx(32.767));
    CHECK(board.decode(board.encode_status(1, 0)).reason == Reason::encoder_fault);
    CHECK(board.decode(board.encode_status(0, 1U << 31)).reason == Reason::device_fault);
}

} // namespace icub_2foc_test
