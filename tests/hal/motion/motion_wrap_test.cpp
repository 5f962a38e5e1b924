// SPDX-License-Identifier: Apache-2.0
// Joints whose range is wider than the integer of their encoder, or lies in another turn of it.
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace motion_wrap_test {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;
constexpr double count_rad = 1e-5;

/// A reading of a joint at `position_rad` by an integer that wraps after `turn_rad`.
EncoderReading wrapped_reading(int tick, double position_rad, double turn_rad) {
    return {.stamp_ns = tick * period,
            .position_rad = std::remainder(position_rad, turn_rad),
            .step_rad = count_rad,
            .wrap_rad = turn_rad,
            .from_zero_rad = 100};
}

TEST_CASE("after a silence, a wrapping integer qualifies where only one turn lies within the range") {
    constexpr double turn_rad = 2;
    const auto swing = [](int tick) { return 1.2 * std::sin(4e-3 * tick); };
    MotionGate gate({.limits = {20, 100},
                     .range = {-1.4, 1.4}, // another turn is possible beyond 0.6 rad
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    const auto trusted = [&](int from, int to) {
        int count = 0;
        for (int tick = from; tick < to; ++tick) {
            const auto verdict = gate.take(wrapped_reading(tick, swing(tick), turn_rad));
            CHECK((verdict.reason != Reason::ok || verdict.position_rad == Approx(swing(tick)).margin(1e-9)));
            count += verdict.reason == Reason::ok ? 1 : 0;
        }
        return count;
    };
    CHECK(trusted(0, 500) == 491);
    CHECK(trusted(700, 900) == 191);  // from 0.4 rad
    CHECK(trusted(1100, 1430) == 0);  // from -1.1 rad, or 0.9 rad
    CHECK(trusted(1430, 2000) > 500); // at less than 0.6 rad
}

TEST_CASE("a device that is not ready once in another turn of its integer qualifies with ten readings") {
    constexpr double turn_rad = 6.283185307179586;
    const auto position_rad = [](int tick) { return 6.6 + 0.3 * std::sin(4e-3 * tick); };
    MotionGate gate({.limits = {5, 20},
                     .range = {4, 9}, // the turn after that of the device's numbers
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    const auto take = [&](int tick) {
        return gate.take(wrapped_reading(tick, position_rad(tick), turn_rad)).reason;
    };
    for (int tick = 0; tick < 20; ++tick) {
        CHECK((take(tick) == Reason::ok) == (tick >= 9));
    }
    gate.interrupt(wrapped_reading(20, position_rad(20), turn_rad));
    for (int tick = 21; tick < 40; ++tick) {
        CHECK((take(tick) == Reason::ok) == (tick >= 30));
    }
}

} // namespace motion_wrap_test
