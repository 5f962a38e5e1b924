// SPDX-License-Identifier: Apache-2.0
// What is known about a joint's encoder decides what its readings after a silence mean.
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"

#include <cmath>

namespace motion_encoder_test {

using dfdyn::hal::Encoder;
using dfdyn::hal::MotionGate;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;
constexpr int silent_from = 20, silent_to = 80; // ticks

double truth(int tick) { return 0.3 + 0.6 * std::sin(4e-3 * tick); }

/// A joint whose encoder has its own zero at `zero_rad`.
struct Joint {
    Encoder encoder;
    double zero_rad;
    MotionGate gate{{.limits = {.velocity = 5, .acceleration = 20, .encoder = encoder},
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = period / 10,
                     .qualification = {.readings = 10, .zero_readings = 1000}}};

    /// Passes the true positions, plus an offset, of ticks [from, to), and returns the last reason.
    Reason take(int from, int to, double off_rad = 0) {
        Reason last = Reason::ok;
        for (int tick = from; tick < to; ++tick) {
            const double position_rad = truth(tick) + off_rad;
            last = gate.take({.stamp_ns = tick * period,
                              .position_rad = position_rad,
                              .step_rad = 1e-5,
                              .from_zero_rad = position_rad - zero_rad})
                       .reason;
        }
        return last;
    }

    /// Returns the last reason after a silence in which the device contradicted itself, and 300 readings with
    /// this offset.
    Reason after_doubt(double off_rad) {
        take(0, silent_from);
        gate.contradict();
        return take(silent_to, silent_to + 300, off_rad);
    }
};

TEST_CASE("a joint that returns at its encoder's zero is trusted only if the encoder is absolute") {
    const auto returned = [](Encoder encoder) {
        Joint joint{encoder, truth(silent_to)};
        joint.take(0, silent_from);
        return joint.take(silent_to, silent_to + 300);
    };
    CHECK(returned(Encoder::absolute) == Reason::ok);
    CHECK(returned(Encoder::unknown) == Reason::position_lost);
    CHECK(returned(Encoder::incremental) == Reason::position_lost);
}

TEST_CASE("in doubt an incremental encoder is lost where it can have counted to from its zero") {
    const double off_rad = 0.05;                             // can be reached, but is wrong
    const double counted_rad = truth(silent_to) - truth(50); // since a restart at tick 50
    const double zero_rad = truth(silent_to) + off_rad - counted_rad;
    CHECK(Joint{Encoder::unknown, zero_rad}.after_doubt(off_rad) == Reason::ok);
    CHECK(Joint{Encoder::incremental, zero_rad}.after_doubt(off_rad) == Reason::position_lost);
    CHECK(Joint{Encoder::incremental, 2}.after_doubt(0) == Reason::ok);
    Joint without_doubt{Encoder::incremental, zero_rad};
    without_doubt.take(0, silent_from);
    CHECK(without_doubt.take(silent_to, silent_to + 300, off_rad) == Reason::ok);
}

TEST_CASE("an absolute encoder is lost while it shows positions that the joint cannot have") {
    Joint joint{Encoder::absolute, truth(silent_from) + 0.4};
    joint.take(0, silent_from);
    CHECK(joint.take(silent_from, silent_from + 100, 0.4) == Reason::position_lost);
    CHECK(joint.take(silent_from + 100, silent_from + 400) == Reason::ok);
}

} // namespace motion_encoder_test
