// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/clock/sync_step.hpp"
#include "tests/support/catch.hpp"

namespace sync_step_test {

using namespace dfdyn::hal;

constexpr std::int64_t us = 1000;
constexpr std::int64_t period = 2000 * us;

/// Returns the state of a device that answers `cycles` SYNCs after 400 µs.
SyncStep running(int cycles) {
    SyncStep step;
    for (int cycle = 0; cycle < cycles; ++cycle) {
        step.sync(cycle * period);
        CHECK(step.answer(cycle * period + 400 * us));
    }
    return step;
}

TEST_CASE("no answer is in step before the first SYNC") { CHECK_FALSE(SyncStep().answer(5 * us)); }

TEST_CASE("after a lost answer, later answers at the usual time are in step") {
    SyncStep step = running(50);
    step.sync(50 * period);
    step.sync(51 * period);
    CHECK(step.answer(51 * period + 420 * us));
}

TEST_CASE("late answers on a loaded bus do not change the usual time") {
    SyncStep step = running(50);
    int cycle = 50;
    for (; cycle < 80; ++cycle) {
        step.sync(cycle * period);
        CHECK(step.answer(cycle * period + (400 + 20 * (cycle - 50)) * us));
    }
    step.sync(cycle++ * period); // its answer is lost
    for (; cycle < 120; ++cycle) {
        step.sync(cycle * period);
        CHECK(step.answer(cycle * period + 400 * us));
    }
}

TEST_CASE("an answer stamped before its SYNC is not in step and does not change the usual time") {
    SyncStep step = running(50);
    step.sync(50 * period + 3000 * us); // a stamp ahead
    CHECK_FALSE(step.answer(50 * period + 400 * us));
    for (int cycle = 51; cycle < 60; ++cycle) {
        step.sync(cycle * period);
        CHECK(step.answer(cycle * period + 400 * us));
    }
}

TEST_CASE("an answer after the next SYNC is not assigned to that SYNC") {
    SyncStep step = running(50);
    step.sync(50 * period);
    step.sync(51 * period);
    CHECK_FALSE(step.answer(51 * period + 100 * us)); // to SYNC 50
    CHECK_FALSE(step.answer(51 * period + 800 * us)); // to SYNC 51, but ambiguous
    CHECK_FALSE(step.late());
    step.sync(52 * period);
    CHECK(step.answer(52 * period + 400 * us));
}

TEST_CASE("if all answers are a period late, none is in step until two come between two SYNCs") {
    SyncStep step = running(50);
    step.sync(50 * period);
    for (int cycle = 51; cycle < 140; ++cycle) {
        step.sync(cycle * period);
        CHECK_FALSE(step.answer(cycle * period + 900 * us));
    }
    CHECK_FALSE(step.answer(139 * period + 1200 * us));
    step.sync(140 * period);
    CHECK(step.answer(140 * period + 400 * us));
}

TEST_CASE("after two lost answers and a lost SYNC, the answers to the next SYNC are valid") {
    SyncStep step = running(50);
    step.sync(50 * period);
    step.sync(51 * period);
    CHECK_FALSE(step.answer(52 * period + 420 * us)); // to SYNC 52, which was lost
    step.sync(53 * period);
    CHECK(step.answer(53 * period + 400 * us));
}

TEST_CASE("after a lost answer, one that is a period late is not assigned to a lost SYNC") {
    SyncStep step = running(50);
    step.sync(50 * period);
    step.sync(51 * period);
    CHECK_FALSE(step.answer(51 * period + 1950 * us)); // to SYNC 50
    step.sync(52 * period);
    CHECK_FALSE(step.answer(52 * period + 400 * us)); // to SYNC 51
}

TEST_CASE("an answer just before the next SYNC is in step, if that is the usual time") {
    SyncStep step;
    for (int cycle = 0; cycle < 50; ++cycle) {
        step.sync(cycle * period);
        CHECK(step.answer(cycle * period + 1150 * us)); // a frame fills more than half of the period
    }
    step.sync(50 * period);
    CHECK(step.answer(50 * period + 1800 * us)); // it waited for another frame
    step.sync(51 * period);
    CHECK_FALSE(step.answer(51 * period + 2750 * us)); // SYNC 52 was lost, and came early
}

TEST_CASE("after a lost SYNC, its answer is not assigned to the SYNC before") {
    SyncStep step = running(50);
    CHECK_FALSE(step.answer(50 * period + 400 * us)); // the second since SYNC 49
    CHECK(step.late());                               // does not affect the first one
    step.sync(51 * period);
    CHECK(step.answer(51 * period + 400 * us));
}

TEST_CASE("two answers with a lost SYNC between them do not prove that a device caught up") {
    SyncStep step = running(50);
    step.sync(50 * period);
    for (int cycle = 51; cycle < 200; ++cycle) { // each answer is now for the SYNC before
        if (cycle % 10 != 5) {
            step.sync(cycle * period);
        }
        CHECK_FALSE(step.answer(cycle * period + 700 * us));
    }
}

TEST_CASE("an answer and a copy of the one before do not prove that a device caught up") {
    SyncStep step = running(50);
    step.sync(50 * period);
    for (int cycle = 51; cycle < 200; ++cycle) { // each answer is now for the SYNC before
        step.sync(cycle * period);
        if (cycle % 5 == 0) {
            CHECK_FALSE(step.answer(cycle * period + 550 * us, true));
        }
        CHECK_FALSE(step.answer(cycle * period + 700 * us));
    }
}

TEST_CASE("an answer with the data of one of the two before may be a copy") {
    AnswerContents contents;
    const auto frame = [](std::uint8_t value) {
        Frame one;
        one.data[3] = value;
        return one;
    };
    CHECK_FALSE(contents.take(frame(1)));
    CHECK_FALSE(contents.take(frame(2)));
    CHECK(contents.take(frame(1)));
    CHECK_FALSE(contents.take(frame(3)));
    CHECK_FALSE(contents.take(frame(2)));
}

} // namespace sync_step_test
