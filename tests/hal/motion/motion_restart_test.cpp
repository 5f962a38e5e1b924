// SPDX-License-Identifier: Apache-2.0
// Encoders that count from where they were switched on, while another fault hides the restart.
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace motion_restart_test {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;

EncoderReading reading_at(std::int64_t stamp_ns, double position_rad, double zero_rad) {
    return {.stamp_ns = stamp_ns,
            .position_rad = position_rad,
            .step_rad = 1e-5,
            .from_zero_rad = position_rad - zero_rad,
            .zero = position_rad == zero_rad};
}

/// A joint in motion: 1 rad/s on average.
double truth(int tick) { return 0.3 + 0.6 * std::sin(4e-3 * tick + 0.5); }

MotionGate new_gate() {
    return MotionGate({.limits = {5, 20},
                       .range = {-3, 3},
                       .max_age_ns = 3 * period,
                       .period_ns = period,
                       .jitter_ns = 0,
                       .qualification = {.readings = 10, .zero_readings = 1000}});
}

/// An encoder that restarts at a tick, with its own number at 0. Its zero is so close to the joint's path
/// that after a silence the joint could be at the encoder's new reading.
struct Restart {
    int began = 0;
    double off_rad = 0.1; ///< distance of the joint from the zero at the restart
    double zero_rad = truth(began) + off_rad;

    [[nodiscard]] EncoderReading at(int tick, double position_rad) const {
        return reading_at(tick * period, position_rad, zero_rad);
    }
    /// Returns its reading after the restart.
    [[nodiscard]] double counted(int tick) const { return zero_rad + truth(tick) - truth(began); }
    [[nodiscard]] EncoderReading reading(int tick) const { return at(tick, counted(tick)); }

    /// Returns a gate that trusts the readings before the restart.
    [[nodiscard]] MotionGate trusting_gate() const {
        MotionGate gate = new_gate();
        for (int tick = 0; tick < 20; ++tick) {
            gate.take(at(tick, truth(tick)));
        }
        return gate;
    }

    /// Passes the readings of ticks [from, to) and checks that none is trusted. Returns the last reason.
    Reason refused(MotionGate& gate, int from, int to) const {
        Reason last = Reason::ok;
        bool any = false;
        for (int tick = from; tick < to; ++tick) {
            last = gate.take(reading(tick)).reason;
            any = any || last == Reason::ok;
        }
        CHECK_FALSE(any);
        return last;
    }
};

TEST_CASE("a restart is detected by its zero despite a wrong next reading") {
    const Restart restart{.began = 120};
    MotionGate gate = restart.trusting_gate();
    gate.take(restart.reading(120));
    gate.take(restart.at(121, restart.zero_rad - 8.4e-3)); // late, of another sender, or a flipped bit
    CHECK(restart.refused(gate, 122, 900) == Reason::position_lost);
}

TEST_CASE("a restart is detected by its zero despite lost readings") {
    const Restart restart{.began = 120};
    MotionGate gate = restart.trusting_gate();
    CHECK(restart.refused(gate, 120, 122) == Reason::qualifying);
    CHECK(restart.refused(gate, 128, 900) == Reason::position_lost); // six were lost
}

TEST_CASE("a restart is detected by its zero despite a reported fault soon after") {
    const Restart restart{.began = 120};
    MotionGate gate = restart.trusting_gate();
    CHECK(restart.refused(gate, 120, 122) == Reason::qualifying);
    gate.interrupt(restart.reading(122));
    CHECK(restart.refused(gate, 128, 900) == Reason::position_lost);
}

TEST_CASE("a restart is detected by the zero of a device that reports a fault") {
    const Restart restart{.began = 120};
    MotionGate gate = restart.trusting_gate();
    gate.interrupt(restart.reading(120));
    CHECK(restart.refused(gate, 124, 900) == Reason::position_lost);
}

TEST_CASE("readings of unknown time that jump to the zero and count from there show a restart") {
    const Restart restart{.began = 24};
    MotionGate gate = restart.trusting_gate();
    for (int tick = 20; tick < 200; ++tick) {
        gate.glance(restart.at(tick, tick < 24 ? truth(tick) : restart.counted(tick)));
    }
    CHECK(restart.refused(gate, 200, 900) == Reason::position_lost);
}

TEST_CASE("readings of unknown time that pass the zero with the joint show no restart") {
    const auto passing = [](int tick) { return reading_at(tick * period, 2e-3 * (tick - 30) + 1e-5, 0); };
    MotionGate gate = new_gate();
    for (int tick = 0; tick < 20; ++tick) {
        gate.take(passing(tick));
    }
    for (int tick = 20; tick < 40; ++tick) {
        gate.glance(passing(tick));
    }
    Reason last = Reason::position_lost;
    for (int tick = 40; tick < 60; ++tick) {
        last = gate.take(passing(tick)).reason;
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a change to another run during qualification requires twenty times as many readings") {
    const Restart far{.off_rad = -2}; // no reading is near the zero
    MotionGate gate = far.trusting_gate();
    for (int tick = 60; tick < 65; ++tick) {
        gate.take(far.at(tick, truth(tick)));
    }
    for (int tick = 65; tick < 264; ++tick) { // a bit is stuck from here on
        CAPTURE(tick);
        CHECK(gate.take(far.at(tick, truth(tick) + 0.04)).reason != Reason::ok);
    }
}

TEST_CASE("a run from the zero shows a restart, even if a silence ends it early") {
    const Restart restart{.began = 24};
    MotionGate gate = restart.trusting_gate();
    restart.refused(gate, 24, 30); // four readings were lost
    CHECK(restart.refused(gate, 80, 900) == Reason::position_lost);
}

TEST_CASE("a clock step forward does not connect rejected readings") {
    const Restart far{.off_rad = -2};           // no reading is near the zero
    const bool noticed = GENERATE(false, true); // a step forward may be taken for a silence
    MotionGate gate = far.trusting_gate();
    const auto shifted = [&](int tick, std::int64_t clock_ns) {
        EncoderReading reading = far.at(tick, truth(tick) + 0.3);
        reading.stamp_ns += clock_ns;
        return gate.take(reading).reason;
    };
    for (int tick = 20; tick < 56; ++tick) {
        CHECK(shifted(tick, 0) != Reason::ok);
    }
    if (noticed) {
        gate.forget_time();
    }
    for (int tick = 56; tick < 400; ++tick) {
        CAPTURE(tick, noticed);
        CHECK(shifted(tick, 7'000'000'000) == Reason::position_lost);
    }
}

TEST_CASE("an encoder that has lost its zero remains lost while the clock is set back") {
    const Restart far{.off_rad = -2}; // no reading is near the zero
    MotionGate gate = far.trusting_gate();
    for (int tick = 20; tick < 600; ++tick) {
        gate.take(far.at(tick, truth(tick) + 0.2));
    }
    REQUIRE(gate.lost());
    gate.forget_time();
    for (int tick = 800; tick < 1400; ++tick) { // stamps are 0.4 s early
        CAPTURE(tick);
        CHECK(gate.take(far.at(tick - 200, truth(tick) + 0.2)).reason == Reason::position_lost);
    }
}

TEST_CASE("a restart is detected despite a second sender") {
    const Restart restart{.began = 136};
    MotionGate gate = restart.trusting_gate();
    for (int tick = 136; tick < 225; ++tick) {
        CAPTURE(tick);
        CHECK(gate.take(restart.reading(tick)).reason != Reason::ok);
        const double other_rad = restart.zero_rad - 0.7 * (restart.counted(tick) - restart.zero_rad);
        const EncoderReading other = reading_at(tick * period + period / 2, other_rad, restart.zero_rad);
        CHECK(gate.take(other).reason != Reason::ok);
    }
    CHECK(restart.refused(gate, 225, 900) == Reason::position_lost);
}

TEST_CASE("a joint that passes its zero is trusted after one reading of a device that is not ready") {
    const auto passing = [](int tick) { return reading_at(tick * period, 2e-3 * (tick - 230) + 1e-5, 0); };
    MotionGate gate = new_gate();
    Reason last = Reason::position_lost;
    for (int tick = 0; tick < 260; ++tick) {
        if (tick == 229) {
            gate.interrupt(passing(tick));
        } else if (tick < 20 || tick > 222) { // a silence, and nine readings before the interruption
            last = gate.take(passing(tick)).reason;
        }
    }
    CHECK(last == Reason::ok);
}

} // namespace motion_restart_test
