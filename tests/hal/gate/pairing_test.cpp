// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/pairing.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <vector>

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Result = PairGate::Result;

namespace {

constexpr std::int64_t us = 1000;
constexpr std::int64_t window_ns = 400 * us;

/// Half `part` of wrench `number` of a sensor with a period of 1 ms; the second half comes 130 µs later.
Frame half(int number, int part) {
    Frame frame = frame_of(part == 0 ? 0x3DA : 0x3DB, {static_cast<std::uint8_t>(number)});
    frame.stamp_ns = (1000 * number + 130 * part) * us;
    return frame;
}

Result push(PairGate& gate, int number, int part) { return gate.push(part, half(number, part)); }

} // namespace

TEST_CASE("two halves of one wrench are paired") {
    PairGate gate(window_ns);
    for (int number = 0; number < 10; ++number) {
        CHECK(push(gate, number, 0) == Result::waiting);
        REQUIRE(push(gate, number, 1) == Result::paired);
        CHECK(gate.first().data[0] == number);
        CHECK(gate.second().data[0] == number);
    }
    CHECK(gate.pairs() == 10);
    CHECK(gate.orphans(0) + gate.orphans(1) == 0);
}

TEST_CASE("a lost second half costs one wrench") {
    PairGate gate(window_ns);
    push(gate, 0, 0);
    CHECK(push(gate, 1, 0) == Result::orphaned);
    CHECK(gate.orphan_ns() == half(0, 0).stamp_ns);
    CHECK(push(gate, 1, 1) == Result::paired);
    CHECK(gate.first().data[0] == 1);
    CHECK(gate.orphans(0) == 1);
}

TEST_CASE("a lost first half costs one wrench") {
    PairGate gate(window_ns);
    CHECK(push(gate, 0, 1) == Result::waiting);
    CHECK(push(gate, 1, 0) == Result::orphaned); // the second half that waited is too old
    CHECK(gate.orphan_ns() == half(0, 1).stamp_ns);
    CHECK(push(gate, 1, 1) == Result::paired);
    CHECK(gate.orphans(1) == 1);
}

TEST_CASE("halves of two wrenches never make one") {
    PairGate gate(window_ns);
    push(gate, 0, 0); // its second half is lost, and the first of the next
    CHECK(push(gate, 1, 1) == Result::orphaned);
    CHECK(push(gate, 2, 0) == Result::orphaned);
    CHECK(push(gate, 2, 1) == Result::paired);
    CHECK(gate.pairs() == 1);
}

TEST_CASE("a sensor all of whose second halves are lost gives no wrench") {
    PairGate gate(window_ns);
    for (int number = 0; number < 100; ++number) {
        CHECK(push(gate, number, 0) != Result::paired);
    }
    CHECK(gate.orphans(0) == 99);
}

TEST_CASE("halves that overtook each other on the way are paired by their stamps") {
    PairGate gate(window_ns);
    CHECK(push(gate, 0, 1) == Result::waiting);
    CHECK(push(gate, 0, 0) == Result::paired);
}

TEST_CASE("halves that were sent in the wrong order are not paired") {
    PairGate gate(window_ns);
    for (int number = 0; number < 10; ++number) {
        CHECK(gate.push(1, at_time(half(number, 1), 1000 * number * us)) != Result::paired);
        CHECK(gate.push(0, at_time(half(number, 0), (1000 * number + 130) * us)) != Result::paired);
    }
    CHECK(gate.orphans(0) + gate.orphans(1) == 19);
}

TEST_CASE("halves without stamps of their own are paired in their order") {
    PairGate gate(window_ns);
    for (int number = 0; number < 5; ++number) { // all read at once
        CHECK(gate.push(0, at_time(half(number, 0), 7 * us)) == Result::waiting);
        CHECK(gate.push(1, at_time(half(number, 1), 7 * us)) == Result::paired);
    }
    gate.push(1, at_time(half(5, 1), 7 * us));
    CHECK(gate.push(0, at_time(half(6, 0), 7 * us)) == Result::orphaned);
    CHECK(gate.push(1, at_time(half(6, 1), 7 * us)) == Result::paired);
}

TEST_CASE("a second sender on the same identifiers is seen, and its halves are not mixed with the first's") {
    for (const std::int64_t behind_us : {60, 300}) { // interleaved, and one wrench after the other
        PairGate gate(window_ns);
        for (int number = 0; number < 10; ++number) {
            std::vector<Frame> frames{half(number, 0), half(number, 1)};
            for (Frame frame : {half(number, 0), half(number, 1)}) {
                frame.stamp_ns += behind_us * us;
                frame.data[0] = 99;
                frames.push_back(frame);
            }
            std::ranges::sort(frames, {}, &Frame::stamp_ns);
            for (const Frame& frame : frames) {
                if (gate.push(frame.id == 0x3DA ? 0 : 1, frame) == Result::paired) {
                    CHECK(gate.first().data[0] == number);
                    CHECK(gate.second().data[0] == number);
                }
            }
        }
        CHECK(gate.doubles() == 20);
    }
}

TEST_CASE("the window's end still counts, and no more") {
    for (const std::int64_t late : {std::int64_t{0}, std::int64_t{1}}) {
        PairGate gate(window_ns);
        gate.push(0, at_time(half(0, 0), 0));
        CHECK(gate.push(1, at_time(half(0, 1), window_ns + late)) ==
              (late == 0 ? Result::paired : Result::orphaned));
    }
}

TEST_CASE("after a reset a half that waited is forgotten") {
    PairGate gate(window_ns);
    push(gate, 0, 0);
    gate.reset();
    CHECK(push(gate, 0, 1) == Result::waiting);
}
