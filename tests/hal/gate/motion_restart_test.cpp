// SPDX-License-Identifier: Apache-2.0
// Encoders that count from where they were switched on, while another fault hides that.
#include "dfdyn/hal/gate/motion.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace motion_restart_test {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;
constexpr double zero_rad = -1; ///< where the encoder's own number is 0

EncoderReading reading_at(std::int64_t stamp_ns, double position_rad) {
    return {.stamp_ns = stamp_ns,
            .position_rad = position_rad,
            .step_rad = 1e-5,
            .from_zero_rad = position_rad - zero_rad,
            .zero = position_rad == zero_rad};
}
EncoderReading reading(int tick, double position_rad) { return reading_at(tick * period, position_rad); }

/// A joint in motion: 1 rad/s on average.
double truth(int tick) { return 0.3 + 0.6 * std::sin(4e-3 * tick + 0.5); }

/// What an encoder that was switched on at a tick shows.
double counted(int tick, int from) { return zero_rad + truth(tick) - truth(from); }

MotionGate trusting_gate() {
    MotionGate gate({.limits = {5, 20},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    for (int tick = 0; tick < 20; ++tick) {
        gate.take(reading(tick, truth(tick)));
    }
    return gate;
}

/// Whether any of the readings of ticks [from, to) of an encoder switched on at `began` is trusted.
bool trusts_counted(MotionGate& gate, int from, int to, int began) {
    bool any = false;
    for (int tick = from; tick < to; ++tick) {
        any = gate.take(reading(tick, counted(tick, began))).reason == Reason::ok || any;
    }
    return any;
}

TEST_CASE("a restart is recognised by its zero although the next reading is off") {
    MotionGate gate = trusting_gate();
    gate.take(reading(270, zero_rad));
    gate.take(reading(271, zero_rad - 8.4e-3)); // late, of another sender, or a flipped bit
    CHECK_FALSE(trusts_counted(gate, 272, 900, 270));
}

TEST_CASE("a restart is recognised by the zero of a device that reports a fault") {
    MotionGate gate = trusting_gate();
    gate.interrupt(reading(270, zero_rad));
    CHECK_FALSE(trusts_counted(gate, 272, 900, 270));
}

TEST_CASE("readings of unknown time that jump to the zero and count from there show a restart") {
    MotionGate gate = trusting_gate();
    for (int tick = 20; tick < 200; ++tick) {
        gate.glance(reading(tick, tick < 24 ? truth(tick) : counted(tick, 24)));
    }
    CHECK_FALSE(trusts_counted(gate, 200, 900, 24));
}

TEST_CASE("readings of unknown time that pass the zero with the joint show no restart") {
    const auto passing = [](int tick) { return zero_rad + 2e-3 * (tick - 30) + 1e-5; };
    MotionGate gate({.limits = {5, 20},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    for (int tick = 0; tick < 20; ++tick) {
        gate.take(reading(tick, passing(tick)));
    }
    for (int tick = 20; tick < 40; ++tick) {
        gate.glance(reading(tick, passing(tick)));
    }
    Reason last = Reason::ok;
    for (int tick = 40; tick < 60; ++tick) {
        last = gate.take(reading(tick, passing(tick))).reason;
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("readings that change to another run while they qualify are believed after twenty times as many") {
    MotionGate gate = trusting_gate();
    for (int tick = 60; tick < 65; ++tick) {
        gate.take(reading(tick, truth(tick)));
    }
    for (int tick = 65; tick < 264; ++tick) { // a bit that is stuck from here on
        CAPTURE(tick);
        CHECK(gate.take(reading(tick, truth(tick) - 0.04)).reason != Reason::ok);
    }
}

TEST_CASE("a run from the zero that a silence ends before it is judged shows a restart") {
    MotionGate gate = trusting_gate();
    CHECK_FALSE(trusts_counted(gate, 24, 30, 24)); // three readings were lost
    CHECK_FALSE(trusts_counted(gate, 80, 900, 24));
}

TEST_CASE("an encoder that has lost its zero stays so while the clock is set back") {
    MotionGate gate = trusting_gate();
    for (int tick = 20; tick < 600; ++tick) {
        gate.take(reading(tick, truth(tick) + 0.5));
    }
    REQUIRE(gate.lost());
    gate.forget_time();
    for (int tick = 800; tick < 1400; ++tick) { // stamps are 0.4 s early
        const Reason reason = gate.take(reading(tick - 200, truth(tick) + 0.5)).reason;
        CHECK(reason != Reason::ok);
    }
}

TEST_CASE("a restart is recognised between the readings of a second sender") {
    MotionGate gate = trusting_gate();
    for (int tick = 136; tick < 225; ++tick) {
        const double own_rad = counted(tick, 136);
        CHECK(gate.take(reading(tick, own_rad)).reason != Reason::ok);
        const double other_rad = zero_rad - 0.7 * (own_rad - zero_rad);
        CHECK(gate.take(reading_at(tick * period + period / 2, other_rad)).reason != Reason::ok);
    }
    CHECK_FALSE(trusts_counted(gate, 225, 900, 136));
}

TEST_CASE("a device that was not itself for a reading goes on where its joint passes the zero") {
    const auto passing = [](int tick) { return 2e-3 * (tick - 230) + zero_rad + 1e-5; };
    MotionGate gate({.limits = {5, 20},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    Reason last = Reason::ok;
    for (int tick = 0; tick < 260; ++tick) {
        if (tick == 229) {
            gate.interrupt(reading(tick, passing(tick)));
        } else if (tick < 20 || tick > 222) { // a silence, and nine readings before the interruption
            last = gate.take(reading(tick, passing(tick))).reason;
        }
    }
    CHECK(last == Reason::ok);
}

} // namespace motion_restart_test
