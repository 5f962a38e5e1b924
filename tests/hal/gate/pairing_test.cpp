// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/pairing.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <vector>

namespace pairing_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;
using Result = PairGate::Result;

namespace {

constexpr std::int64_t us = 1000;
constexpr std::int64_t window_ns = 400 * us;
constexpr PairGate::Config quiet_bus{.period_ns = 1000 * us, .delay_ns = window_ns};

/// Returns half `part` of wrench `number` of a sensor with a period of 1 ms; the second half comes 130 µs
/// later.
Frame half(int number, int part) {
    Frame frame = frame_of(part == 0 ? 0x3DA : 0x3DB, {static_cast<std::uint8_t>(number)});
    frame.stamp_ns = (1000 * number + 130 * part) * us;
    return frame;
}

Result push(PairGate& gate, int number, int part) { return gate.push(part, half(number, part)); }

} // namespace

TEST_CASE("two halves of one wrench are paired") {
    PairGate gate(quiet_bus);
    for (int number = 0; number < 10; ++number) {
        CHECK(push(gate, number, 0) == Result::waiting);
        REQUIRE(push(gate, number, 1) == Result::paired);
        CHECK(gate.first().data[0] == number);
        CHECK(gate.second().data[0] == number);
    }
    CHECK(gate.pairs() == 10);
    CHECK(gate.unpaired(0) + gate.unpaired(1) == 0);
}

TEST_CASE("a lost second half costs one wrench") {
    PairGate gate(quiet_bus);
    push(gate, 0, 0);
    CHECK(push(gate, 1, 0) == Result::orphaned);
    CHECK(gate.orphan_ns() == half(0, 0).stamp_ns);
    CHECK(push(gate, 1, 1) == Result::paired);
    CHECK(gate.first().data[0] == 1);
    CHECK(gate.unpaired(0) == 1);
}

TEST_CASE("a lost first half costs one wrench") {
    PairGate gate(quiet_bus);
    CHECK(push(gate, 0, 1) == Result::waiting);
    CHECK(push(gate, 1, 0) == Result::orphaned); // the waiting second half is too old
    CHECK(gate.orphan_ns() == half(0, 1).stamp_ns);
    CHECK(push(gate, 1, 1) == Result::paired);
    CHECK(gate.unpaired(1) == 1);
}

TEST_CASE("halves of different wrenches are never paired") {
    PairGate gate(quiet_bus);
    push(gate, 0, 0); // its second half is lost, and the first of the next
    CHECK(push(gate, 1, 1) == Result::orphaned);
    CHECK(push(gate, 2, 0) == Result::orphaned);
    CHECK(push(gate, 2, 1) == Result::paired);
    CHECK(gate.pairs() == 1);
}

TEST_CASE("a sensor all of whose second halves are lost gives no wrench") {
    PairGate gate(quiet_bus);
    for (int number = 0; number < 100; ++number) {
        CHECK(push(gate, number, 0) != Result::paired);
    }
    CHECK(gate.unpaired(0) == 99);
}

TEST_CASE("halves that arrive out of order are paired by their stamps") {
    PairGate gate(quiet_bus);
    CHECK(push(gate, 0, 1) == Result::waiting);
    CHECK(push(gate, 0, 0) == Result::paired);
}

TEST_CASE("halves that were sent in the wrong order are not paired") {
    PairGate gate(quiet_bus);
    for (int number = 0; number < 10; ++number) {
        CHECK(gate.push(1, at_time(half(number, 1), 1000 * number * us)) != Result::paired);
        CHECK(gate.push(0, at_time(half(number, 0), (1000 * number + 130) * us)) != Result::paired);
    }
    CHECK(gate.unpaired(0) + gate.unpaired(1) == 19);
}

TEST_CASE("halves with a shared stamp are paired in their order") {
    PairGate gate(quiet_bus);
    for (int number = 0; number < 5; ++number) { // all read at once
        CHECK(gate.push(0, at_time(half(number, 0), 7 * us)) == Result::waiting);
        CHECK(gate.push(1, at_time(half(number, 1), 7 * us)) == Result::paired);
    }
    gate.push(1, at_time(half(5, 1), 7 * us));
    CHECK(gate.push(0, at_time(half(6, 0), 7 * us)) == Result::orphaned);
    CHECK(gate.push(1, at_time(half(6, 1), 7 * us)) == Result::paired);
}

TEST_CASE("a second sender is detected, and its halves are not mixed with the first's") {
    for (const std::int64_t behind_us :
         {60, 300, 500}) { // interleaved; one wrench after the other; half a period apart
        PairGate gate(quiet_bus);
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
        CHECK(gate.doubles() == (behind_us == 60 ? 20 : 38)); // each is too soon after the other
    }
}

TEST_CASE("the end of the pairing window is included") {
    for (const std::int64_t late : {std::int64_t{0}, std::int64_t{1}}) {
        PairGate gate(quiet_bus);
        gate.push(0, at_time(half(0, 0), 0));
        CHECK(gate.push(1, at_time(half(0, 1), window_ns + late)) ==
              (late == 0 ? Result::paired : Result::orphaned));
    }
}

TEST_CASE("a reset discards a waiting half") {
    PairGate gate(quiet_bus);
    push(gate, 0, 0);
    gate.reset();
    CHECK(push(gate, 0, 1) == Result::waiting);
}

namespace {

/// Wrenches of a sensor on a bus at 80 % load: each half waits up to 0.78 ms, the second behind the first.
std::vector<Frame> wait_for_the_bus(std::mt19937_64& engine, int wrenches) {
    std::uniform_int_distribution<std::int64_t> queue(115 * us, 655 * us);
    std::vector<Frame> frames;
    for (int number = 0; number < wrenches; ++number) {
        const std::int64_t first_ns = queue(engine);
        const std::int64_t second_ns = std::max(first_ns, queue(engine)) + 125 * us;
        for (const int part : {0, 1}) {
            Frame frame = half(number, part);
            frame.data[1] = static_cast<std::uint8_t>(number >> 8);
            frame.stamp_ns = 1000LL * number * us + (part == 0 ? first_ns : second_ns);
            frames.push_back(frame);
        }
    }
    return frames;
}

constexpr PairGate::Config loaded_bus{.period_ns = 1000 * us, .delay_ns = 780 * us};

bool same_wrench(const PairGate& gate) {
    return gate.first().data[0] == gate.second().data[0] && gate.first().data[1] == gate.second().data[1];
}

} // namespace

TEST_CASE("on a loaded bus, wrenches 0.33 to 1.6 periods apart are all paired") {
    DFDYN_SEEDED_ENGINE(engine);
    PairGate gate(loaded_bus);
    constexpr int start = 50; // until a frame has waited for a long time
    int late = 0;
    for (const Frame& frame : wait_for_the_bus(engine, 20'000)) {
        const Result result = gate.push(frame.id == 0x3DA ? 0 : 1, frame);
        const bool good = result == (frame.id == 0x3DA ? Result::waiting : Result::paired);
        late += frame.stamp_ns > start * 1000 * us && !good ? 1 : 0;
    }
    CHECK(late == 0);
    CHECK(gate.doubles() == 0);
}

TEST_CASE("on a loaded bus with losses, halves of different wrenches are never paired") {
    DFDYN_SEEDED_ENGINE(engine);
    PairGate gate(loaded_bus);
    std::bernoulli_distribution lost(0.3);
    int mixed = 0;
    for (const Frame& frame : wait_for_the_bus(engine, 20'000)) {
        if (!lost(engine) && gate.push(frame.id == 0x3DA ? 0 : 1, frame) == Result::paired) {
            mixed += same_wrench(gate) ? 0 : 1;
        }
    }
    CHECK(mixed == 0);
    CHECK(gate.pairs() > 8'000); // of 9,800 without a lost half
    CHECK(gate.doubles() == 0);
}

} // namespace pairing_test
