// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <random>

namespace motion_test {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t period = 2 * ms;
constexpr double count_rad = 1e-5;

MotionGate make_gate(double highest_rad = 3) {
    return MotionGate({.limits = {5, 20},
                       .range = {-highest_rad, highest_rad},
                       .max_age_ns = 3 * period,
                       .period_ns = period,
                       .jitter_ns = 0,
                       .qualification = {.readings = 10, .zero_readings = 1000}});
}

EncoderReading reading(int tick, double position_rad) {
    return {.stamp_ns = tick * period,
            .position_rad = position_rad,
            .step_rad = count_rad,
            .from_zero_rad = position_rad + 1,
            .zero = position_rad == -1};
}

/// A joint in motion: 1 rad/s on average, 6 rad/s² at most.
double truth(int tick) {
    const double t = 2e-3 * tick;
    return 0.3 + 0.6 * std::sin(2 * t + 0.5);
}

/// Takes the true positions of ticks [from, to), and returns the last reason.
Reason follow(MotionGate& gate, int from, int to, double offset_rad = 0) {
    Reason last = Reason::ok;
    for (int tick = from; tick < to; ++tick) {
        last = gate.take(reading(tick, truth(tick) + offset_rad)).reason;
    }
    return last;
}

MotionGate ready_gate() {
    MotionGate gate = make_gate();
    follow(gate, 0, 20);
    return gate;
}

TEST_CASE("a joint is trusted after ten consistent readings") {
    MotionGate gate = make_gate();
    CHECK(follow(gate, 0, 9) == Reason::qualifying);
    CHECK(follow(gate, 9, 10) == Reason::ok);
    CHECK(follow(gate, 10, 3000) == Reason::ok);
    CHECK(gate.position_rad().value() == Approx(truth(2999)));
}

TEST_CASE("an impossible position is rejected, and the next correct one is trusted") {
    for (const double off_rad : {2e-3, -0.02, 0.5, -2.2}) {
        MotionGate gate = ready_gate();
        CAPTURE(off_rad);
        CHECK(gate.take(reading(20, truth(20) + off_rad)).reason == Reason::position_jump);
        CHECK(follow(gate, 21, 22) == Reason::ok);
        CHECK(gate.position_rad().value() == Approx(truth(21)));
    }
}

TEST_CASE("a repeated position of a moving joint is rejected") {
    MotionGate gate = ready_gate();
    CHECK(gate.take(reading(20, truth(19))).reason == Reason::position_frozen);
    CHECK(follow(gate, 21, 22) == Reason::ok);
}

TEST_CASE("an encoder with a constant offset is rejected until it jumps back") {
    MotionGate gate = ready_gate();
    CHECK(follow(gate, 20, 29, 0.05) == Reason::position_jump);
    CHECK(follow(gate, 29, 5000, 0.05) == Reason::position_lost);
    CHECK(gate.lost());
    // It jumps back: twenty times as many readings are needed.
    CHECK(follow(gate, 5000, 5199) != Reason::ok);
    CHECK(follow(gate, 5199, 5200) == Reason::ok);
}

TEST_CASE("after a silence, a joint is trusted at possible positions, but not at its encoder's zero") {
    MotionGate gate = ready_gate();
    CHECK(follow(gate, 40, 49) == Reason::qualifying);
    CHECK(follow(gate, 49, 50) == Reason::ok);
    CHECK(follow(gate, 70, 80, 0.4) == Reason::position_lost);

    MotionGate restarted = ready_gate();
    for (int tick = 60; tick < 200; ++tick) { // encoder and joint at -1 rad
        const double position_rad = -1 + 0.1 * (truth(tick) - truth(60));
        CHECK(restarted.take(reading(tick, position_rad)).reason != Reason::ok);
    }
}

TEST_CASE("an encoder that has lost its zero is rejected after any jump") {
    for (const int seen : {0, 1, 3}) { // correct readings between the silence and the restart
        MotionGate gate = ready_gate();
        follow(gate, 270, 270 + seen);
        const double offset_rad = -1 - truth(270 + seen);
        CHECK(follow(gate, 270 + seen, 700, offset_rad) == Reason::position_lost);
        CHECK(follow(gate, 700, 1500) == Reason::position_lost);
    }
}

TEST_CASE("readings of unknown time only reveal a lost zero") {
    MotionGate gate = ready_gate();
    gate.glance(reading(20, truth(20) + 1e-3));
    gate.glance(reading(20, -1)); // exactly zero: no position yet
    CHECK(follow(gate, 20, 22) == Reason::ok);
    gate.glance(reading(22, -1 + count_rad));
    CHECK(follow(gate, 22, 900) == Reason::position_lost);
}

TEST_CASE("an impact changes the velocity, and is accepted after ten readings") {
    MotionGate gate = make_gate();
    int tick = 0;
    for (; tick < 50; ++tick) {
        gate.take(reading(tick, 2e-3 * tick));
    }
    Reason last = Reason::ok;
    for (; tick < 62; ++tick) {
        last = gate.take(reading(tick, 2e-3 * 49 - 1e-3 * (tick - 49))).reason;
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a jump within the velocity limit is finally accepted if at most one reading was lost") {
    for (const int lost : {0, 1, 2, 5}) {
        CAPTURE(lost);
        MotionGate gate = ready_gate();
        const double jump_rad = 8e-3 * (lost + 1);
        const Reason last = follow(gate, 20 + lost, 900, jump_rad);
        CHECK(last == (lost < 2 ? Reason::ok : Reason::position_lost));
    }
}

TEST_CASE("a frozen encoder is rejected if the joint cannot have stopped; a joint at rest is accepted") {
    MotionGate gate = ready_gate();
    for (int tick = 20; tick < 500; ++tick) {
        CHECK(gate.take(reading(tick, truth(19))).reason == Reason::position_frozen);
    }
    CHECK(follow(gate, 500, 515) == Reason::ok);

    MotionGate resting = make_gate();
    for (int tick = 0; tick < 500; ++tick) { // comes to rest with 10 rad/s²
        const double t = std::min(2e-3 * tick, 0.1);
        const Reason reason = resting.take(reading(tick, t - 5 * t * t)).reason;
        CHECK((tick < 9 || reason == Reason::ok));
    }
}

TEST_CASE("elapsed time after a jump does not make its positions acceptable") {
    MotionGate gate = make_gate();
    for (int tick = 0; tick < 20; ++tick) {
        gate.take(reading(tick, 1e-3 * tick));
    }
    for (int tick = 20; tick < 29; ++tick) {
        CHECK(gate.take(reading(tick, 1e-3 * tick + 1e-3)).reason == Reason::position_jump);
    }
}

TEST_CASE("a wrapping integer is unwrapped if the turn is unambiguous") {
    const auto wrapped = [](int tick) {
        EncoderReading one = reading(tick, std::remainder(4 * truth(tick), 2.0));
        one.wrap_rad = 2;
        return one;
    };
    MotionGate gate({.limits = {20, 100},
                     .range = {-9, 9},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    const double first_turn = 4 * truth(0) - std::remainder(4 * truth(0), 2.0);
    for (int tick = 0; tick < 2000; ++tick) {
        const MotionGate::Verdict verdict = gate.take(wrapped(tick));
        CHECK((tick < 9 || verdict.reason == Reason::ok));
        CHECK(verdict.position_rad == Approx(4 * truth(tick) - first_turn));
    }
    for (int tick = 3000; tick < 5000; ++tick) { // the turn remains unknown
        CHECK(gate.take(wrapped(tick)).reason == Reason::position_lost);
    }
}

TEST_CASE("only the true clock step explains the positions of a lost joint") {
    for (const auto& [step, believed] : {std::pair{-1.4, true}, std::pair{3.0, false}}) {
        MotionGate gate = ready_gate();
        for (int tick = 20; tick < 40; ++tick) { // stamps are 1.4 ms early
            EncoderReading one = reading(tick, truth(tick));
            one.stamp_ns -= 1'400'000;
            gate.take(one);
        }
        CHECK(gate.lost());
        gate.explain_by_clock(static_cast<std::int64_t>(step * 1e6));
        CHECK(gate.lost() != believed);
    }
}

TEST_CASE("a clock step does not explain a position after a silence") {
    MotionGate gate = ready_gate();
    for (int tick = 400; tick < 420; ++tick) { // counted from where the encoder was switched on
        gate.take(reading(tick, truth(tick) - truth(400) - 1));
    }
    REQUIRE(gate.lost());
    gate.explain_by_clock(300'000); // the rest of the silence within a period
    CHECK(gate.lost());
}

TEST_CASE("a joint that moved past its encoder's zero before a silence was not at rest there") {
    MotionGate gate = make_gate();
    for (int tick = 0; tick < 20; ++tick) {
        gate.take(reading(tick, -1 + 6e-4 * (tick - 19) + count_rad));
    }
    for (int tick = 220; tick < 260; ++tick) { // restarts at zero, at any position of the joint
        CHECK(gate.take(reading(tick, -1 + 6e-4 * (tick - 220) + count_rad)).reason != Reason::ok);
    }
}

TEST_CASE("a restart is detected by a zero shortly before its readings") {
    MotionGate gate = ready_gate();
    gate.take(reading(270, -1));
    for (int tick = 281; tick < 600; ++tick) {
        CHECK(gate.take(reading(tick, -1 + 2.4e-3 * (tick - 270))).reason != Reason::ok);
    }
}

TEST_CASE("an encoder with coarse counts is rejected while it is frozen") {
    constexpr double coarse_rad = 1.745e-3;
    MotionGate gate({.limits = {},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = 250'000,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    const auto coarse = [](int tick) {
        EncoderReading one = reading(tick, coarse_rad * std::round(2.4e-3 * tick / coarse_rad));
        one.step_rad = coarse_rad;
        return one;
    };
    for (int tick = 0; tick < 40; ++tick) {
        gate.take(coarse(tick));
    }
    for (int tick = 40; tick < 400; ++tick) {
        EncoderReading frozen = coarse(39);
        frozen.stamp_ns = tick * period;
        const Reason reason = gate.take(frozen).reason;
        CHECK((tick < 46 || reason != Reason::ok));
    }
}

TEST_CASE("after a clock step, a joint continues its motion; another position needs more readings") {
    for (const double offset_rad : {0.0, -0.06}) {
        MotionGate gate = ready_gate();
        gate.forget_time();
        CAPTURE(offset_rad);
        CHECK((follow(gate, 31, 42, offset_rad) == Reason::ok) == (offset_rad == 0));
    }
}

TEST_CASE("a small jump does not restore a lost zero") {
    MotionGate gate = ready_gate();
    CHECK(follow(gate, 20, 600, 0.5) == Reason::position_lost);
    CHECK(follow(gate, 600, 1200, 0.506) == Reason::position_lost);
}

TEST_CASE("a joint at rest between two counts of 14 bits at 1 kHz does not jump") {
    constexpr double coarse_rad = 6.283185 / (1 << 14);
    MotionGate gate({.limits = {5, 20},
                     .range = {-3, 3},
                     .max_age_ns = 3 * ms,
                     .period_ns = ms,
                     .jitter_ns = 0,
                     .qualification = {.readings = 10, .zero_readings = 1000}});
    DFDYN_SEEDED_ENGINE(engine);
    std::bernoulli_distribution next(0.5);
    int refused = 0;
    for (int tick = 0; tick < 2000; ++tick) {
        const double position_rad = next(engine) ? coarse_rad : 0;
        const EncoderReading dithered{.stamp_ns = tick * ms,
                                      .position_rad = position_rad,
                                      .step_rad = coarse_rad,
                                      .from_zero_rad = position_rad + 1};
        refused += gate.take(dithered).reason != Reason::ok ? 1 : 0;
    }
    CHECK(refused == 9);
}

} // namespace motion_test
