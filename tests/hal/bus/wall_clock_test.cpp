// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/wall_clock.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <random>

namespace {

using dfdyn::hal::HardwareClock;
using dfdyn::hal::WallClock;

constexpr std::int64_t second_ns = 1'000'000'000;
/// wall-clock time when the monotonic clock was 0
constexpr std::int64_t boot_ns = 1'700'000'000 * second_ns;

} // namespace

TEST_CASE("wall-clock time stamps are converted to the monotonic clock") {
    WallClock clock;
    clock.nothing_waiting(5 * second_ns, boot_ns + 5 * second_ns);
    const auto [stamp_ns, plausible] =
        clock.to_monotonic(boot_ns + 6 * second_ns, 7 * second_ns, boot_ns + 7 * second_ns);
    CHECK(plausible);
    CHECK(stamp_ns == 6 * second_ns);
}

TEST_CASE("setting the wall clock moves no time stamp of frames that were waiting or came later") {
    const std::int64_t step_ns = GENERATE(3600 * second_ns, -3600 * second_ns, second_ns, -second_ns);
    CAPTURE(step_ns);
    WallClock clock;
    clock.nothing_waiting(5 * second_ns, boot_ns + 5 * second_ns);
    // Stamped at 5.2, 5.4 and 5.6 s, all read at 5.8 s; the clock was set at 5.5 s.
    const std::int64_t now_ns = 58 * second_ns / 10;
    for (const std::int64_t taken_ns : {52 * second_ns / 10, 54 * second_ns / 10, 56 * second_ns / 10}) {
        const std::int64_t set_ns = taken_ns > 55 * second_ns / 10 ? step_ns : 0;
        const auto [stamp_ns, plausible] =
            clock.to_monotonic(boot_ns + taken_ns + set_ns, now_ns, boot_ns + now_ns + step_ns);
        CHECK(plausible);
        CHECK(stamp_ns == taken_ns);
    }
    clock.nothing_waiting(now_ns, boot_ns + now_ns + step_ns);
    CHECK(
        clock
            .to_monotonic(boot_ns + 6 * second_ns + step_ns, 7 * second_ns, boot_ns + 7 * second_ns + step_ns)
            .stamp_ns == 6 * second_ns);
}

TEST_CASE("setting the wall clock moves no time stamp of a frame that the kernel was delivering") {
    const std::int64_t step_ns = GENERATE(3600 * second_ns, -3600 * second_ns, second_ns, -second_ns);
    const std::int64_t delay_ns = GENERATE(200'000, 20'000'000);
    CAPTURE(step_ns, delay_ns);
    WallClock clock;
    clock.nothing_waiting(5 * second_ns, boot_ns + 5 * second_ns);
    // Stamped at 6 s, just before the clock is set. The next reading finds nothing, the one after it the
    // frame.
    const std::int64_t taken_ns = 6 * second_ns;
    const std::int64_t empty_ns = taken_ns + delay_ns;
    clock.nothing_waiting(empty_ns, boot_ns + empty_ns + step_ns);
    const std::int64_t read_ns = empty_ns + 1'000'000;
    const auto [stamp_ns, plausible] =
        clock.to_monotonic(boot_ns + taken_ns, read_ns, boot_ns + read_ns + step_ns);
    CHECK(plausible);
    CHECK(stamp_ns == taken_ns);
    // A frame of the new time is not mistaken for one of the old time.
    CHECK(clock.to_monotonic(boot_ns + read_ns + step_ns, read_ns + 10, boot_ns + read_ns + 10 + step_ns)
              .stamp_ns == read_ns);
}

TEST_CASE("setting the wall clock by little moves a frame's time stamp by at most that, and not for long") {
    const std::int64_t step_ns = GENERATE(-20'000'000, -5'000'000, 5'000'000, 20'000'000);
    const std::int64_t delay_ns = GENERATE(200'000, 20'000'000, 60'000'000);
    CAPTURE(step_ns, delay_ns);
    WallClock clock;
    clock.nothing_waiting(5 * second_ns, boot_ns + 5 * second_ns);
    const std::int64_t set_ns = 6 * second_ns;
    clock.nothing_waiting(set_ns, boot_ns + set_ns + step_ns);
    clock.nothing_waiting(set_ns + delay_ns - 1000, boot_ns + set_ns + delay_ns - 1000 + step_ns);
    const std::int64_t read_ns = set_ns + delay_ns;
    const auto old_time = clock.to_monotonic(boot_ns + set_ns, read_ns, boot_ns + read_ns + step_ns);
    CHECK(old_time.plausible);
    CHECK(old_time.stamp_ns <= read_ns);
    CHECK(std::abs(old_time.stamp_ns - set_ns) <= std::abs(step_ns));
    const auto new_time =
        clock.to_monotonic(boot_ns + read_ns + step_ns, read_ns, boot_ns + read_ns + step_ns);
    CHECK(new_time.plausible);
    CHECK(new_time.stamp_ns == read_ns);
    // The old difference is forgotten: with it, this stamp would be the time of reading.
    const std::int64_t later_ns = set_ns + second_ns;
    clock.nothing_waiting(later_ns, boot_ns + later_ns + step_ns);
    const auto much_later = clock.to_monotonic(boot_ns + later_ns, later_ns, boot_ns + later_ns + step_ns);
    CHECK(much_later.plausible == (step_ns > 0));
    CHECK(much_later.stamp_ns == later_ns - std::max(step_ns, std::int64_t{0}));
}

TEST_CASE("a time stamp that no difference of the clocks explains becomes the time of reading") {
    WallClock clock;
    clock.nothing_waiting(5 * second_ns, boot_ns + 5 * second_ns);
    const auto [stamp_ns, plausible] =
        clock.to_monotonic(boot_ns + 9 * second_ns, 7 * second_ns, boot_ns + 7 * second_ns);
    CHECK_FALSE(plausible);
    CHECK(stamp_ns == 7 * second_ns);
}

TEST_CASE(
    "time stamps of a drifting controller clock are converted closely and never later than the reading") {
    DFDYN_SEEDED_ENGINE(engine);
    const double speed = GENERATE(1.0, 1.0 + 1e-4, 1.0 - 1e-4);
    CAPTURE(speed);
    std::exponential_distribution<double> delay_ns(1.0 / 50'000.0);
    HardwareClock clock;
    std::int64_t worst_ns = 0;
    for (int sample = 0; sample < 60'000; ++sample) {
        const double taken_ns = 1e6 * sample;
        const auto read_ns = static_cast<std::int64_t>(taken_ns + 20'000.0 + delay_ns(engine));
        const std::int64_t stamp_ns =
            clock.to_monotonic(static_cast<std::int64_t>(123e9 + speed * taken_ns), read_ns);
        REQUIRE(stamp_ns <= read_ns);
        const std::int64_t late_ns = stamp_ns - static_cast<std::int64_t>(taken_ns);
        if (sample >= 1'000) {
            worst_ns = std::max(worst_ns, std::abs(late_ns));
        }
    }
    // The smallest delay is 20 us. Small delays are about 200 ms apart, in which 100 or 200 ppm amount to 40
    // us.
    CHECK(worst_ns < 80'000);
    CHECK(worst_ns > 10'000);
}

TEST_CASE("one stamp of a controller's clock that is ahead does not shift the later ones") {
    constexpr std::int64_t period_ns = 1'000'000, delay_ns = 20'000, ahead_ns = second_ns;
    HardwareClock clock;
    const auto age_of = [&](std::int64_t frame, std::int64_t error_ns) {
        const std::int64_t read_ns = frame * period_ns + delay_ns;
        return read_ns - clock.to_monotonic(frame * period_ns + error_ns, read_ns);
    };
    for (std::int64_t frame = 0; frame < 2000; ++frame) {
        const std::int64_t age_ns = age_of(frame, frame == 1000 ? ahead_ns : 0);
        REQUIRE(age_ns >= 0);
        REQUIRE(age_ns < period_ns);
    }
    for (std::int64_t frame = 2000; frame < 2010; ++frame) { // now the clock is set
        const std::int64_t age_ns = age_of(frame, ahead_ns);
        REQUIRE(age_ns >= 0);
        REQUIRE(age_ns < period_ns);
    }
    CHECK(age_of(2010, ahead_ns + 1000) == 0); // and its new difference is known
}

TEST_CASE("a restart of a controller's clock is detected") {
    HardwareClock clock;
    CHECK(clock.to_monotonic(500 * second_ns, 10 * second_ns) == 10 * second_ns);
    CHECK(clock.to_monotonic(0, 11 * second_ns) == 11 * second_ns);
    CHECK(clock.to_monotonic(second_ns, 12 * second_ns) == 12 * second_ns);
}
