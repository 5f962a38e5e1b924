// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/sample_clock.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <optional>
#include <random>

namespace sample_clock_test {

using dfdyn::tools::SampleClock;

constexpr std::int64_t period = 2'000'000;

/// A clock after ten regular samples; sample k is measured at k periods.
class Line {
  public:
    Line() {
        for (int k = 0; k < 10; ++k) {
            REQUIRE(tick(k) == 0);
        }
    }
    /// Advances by one tick that receives the sample of tick `k`, with a stamp that is `jump_ns` ahead.
    std::optional<int> tick(int k, std::int64_t jump_ns = 0, bool late = false) {
        clock.advance();
        ++next;
        return clock.place(k * period + jump_ns, late);
    }
    void silent_tick() {
        clock.advance();
        ++next;
    }

    SampleClock clock{period};
    int next = 0; ///< number of the next tick
};

TEST_CASE("samples with a jitter of up to half a period belong to their ticks") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_int_distribution<std::int64_t> jitter(-period / 2, period / 2);
    Line line;
    for (int k = 10; k < 1000; ++k) {
        CHECK(line.tick(k, jitter(engine)) == 0);
    }
}

TEST_CASE("after a lost cycle an older sample is used with its own time and then the expected one") {
    Line line;
    line.silent_tick(); // 10
    CHECK(line.tick(10) == -1);
    CHECK(line.tick(12) == 0);
}

TEST_CASE("samples that stay one tick older after a lost cycle are used as such") {
    Line line;
    line.silent_tick();
    for (int k = 10; k < 50; ++k) {
        CHECK(line.tick(k) == -1);
    }
}

TEST_CASE("neither a sample that was used before nor one too old to extrapolate is used") {
    Line line;
    CHECK(line.tick(9) == std::nullopt);
    CHECK(line.tick(9) == std::nullopt);
    CHECK(line.tick(9) == std::nullopt);
    CHECK(line.tick(9) == std::nullopt);
    for (int k = 0; k < SampleClock::max_age; ++k) {
        line.silent_tick();
    }
    CHECK(line.tick(line.next - SampleClock::max_age - 1) == std::nullopt);
}

TEST_CASE("a sample of the next tick is recognised") {
    Line line;
    CHECK(line.tick(11) == 1); // received in a late tick
    line.silent_tick();        // the tick made up for at once
    CHECK(line.tick(12) == 0);
}

TEST_CASE("ticks that are late several times in a row do not move the clock") {
    Line line;
    for (int k = 10; k < 15; ++k) {
        CHECK(line.tick(k + 1, 0, true) == 1);
    }
    line.silent_tick(); // on time again: its sample is known
    for (int k = 16; k < 30; ++k) {
        CHECK(line.tick(k) == 0);
    }
}

TEST_CASE("a wait for the first sample after the start may have any length") {
    Line line;
    for (int k = 0; k < 1000; ++k) {
        line.silent_tick();
    }
    CHECK(line.tick(line.next - SampleClock::max_age) == -SampleClock::max_age);
}

TEST_CASE("stamps that jump are accepted once they have been consistent") {
    for (const std::int64_t jump_ns : {-1'000'000'000, -20'000'000, -4'000'000, 30'000'000, 1'000'000'000}) {
        CAPTURE(jump_ns);
        Line line;
        for (int k = 0; k + 1 < SampleClock::adopt_after; ++k) {
            CHECK(line.tick(line.next, jump_ns) == std::nullopt);
        }
        for (int k = 0; k < 100; ++k) {
            CHECK(line.tick(line.next, jump_ns) == 0);
        }
        CHECK(line.tick(line.next) != 0); // a jump back needs the same
    }
}

TEST_CASE("a single wrong stamp changes nothing") {
    Line line;
    CHECK(line.tick(10, -500'000'000) == std::nullopt);
    CHECK(line.tick(11) == 0);
}

} // namespace sample_clock_test
