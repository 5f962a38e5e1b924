// SPDX-License-Identifier: Apache-2.0
// Readings that the limits of a joint allow, but that must be rejected.
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>

namespace motion_doubt_test {

using dfdyn::hal::EncoderReading;
using dfdyn::hal::MotionGate;
using dfdyn::hal::MotionLimits;
using dfdyn::hal::Reason;

constexpr std::int64_t period = 2'000'000;
constexpr std::int64_t us = 1000;

/// A gate, and a joint whose encoder has its zero at 1 rad.
struct Joint {
    double step_rad = 1e-5;
    MotionLimits limits;
    MotionGate gate{{.limits = limits,
                     .range = {-3, 3},
                     .max_age_ns = 3 * period,
                     .period_ns = period,
                     .jitter_ns = period / 8,
                     .qualification = {.readings = 10, .zero_readings = 1000}}};

    [[nodiscard]] EncoderReading reading(std::int64_t stamp_ns, double position_rad) const {
        const double from_zero_rad = std::round((position_rad - 1) / step_rad) * step_rad;
        return {.stamp_ns = stamp_ns,
                .position_rad = from_zero_rad + 1,
                .step_rad = step_rad,
                .from_zero_rad = from_zero_rad,
                .zero = from_zero_rad == 0};
    }
    Reason take(int tick, double position_rad) {
        return gate.take(reading(tick * period, position_rad)).reason;
    }
    void glance(int tick, double position_rad) { gate.glance(reading(tick * period, position_rad)); }
};

TEST_CASE("a coarse encoder that freezes in motion is rejected while it is frozen") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double step_rad = 1.745e-3;
    std::uniform_real_distribution<double> unit(0, 1);
    for (int run = 0; run < 300; ++run) {
        Joint joint{.step_rad = step_rad, .limits = {5.4, 17}};
        const double phase_rad = step_rad * unit(engine);
        const double speed = (1.46 + 0.1 * unit(engine)) / 500; // rad per tick: five counts in `max_age`
        int trusted = 0;
        for (int tick = 0; tick < 350; ++tick) {
            const auto late_ns = static_cast<std::int64_t>(200'000 * unit(engine));
            const double position_rad = phase_rad + speed * std::min(tick, 200);
            const bool ok =
                joint.gate.take(joint.reading(tick * period + late_ns, position_rad)).reason == Reason::ok;
            trusted += ok && tick >= 205 ? 1 : 0; // before, the joint may have stopped
        }
        CAPTURE(run);
        CHECK(trusted == 0);
    }
}

TEST_CASE("an encoder that froze during readings of unknown time is rejected") {
    Joint joint;
    for (int tick = 0; tick < 200; ++tick) { // at rest
        joint.take(tick, 0.3);
    }
    REQUIRE(joint.take(200, 0.3) == Reason::ok);
    for (int tick = 201; tick < 240; ++tick) { // the joint begins to move
        joint.glance(tick, 0.3 + 1e-3 * (tick - 200));
    }
    for (int tick = 240; tick < 300; ++tick) {
        CHECK(joint.take(tick, 0.34) != Reason::ok);
    }
}

TEST_CASE("after a late reading, one that contradicts two others is rejected") {
    constexpr double speed = 2; // rad/s
    const auto at = [](std::int64_t stamp_ns) { return 0.3 + speed * 1e-9 * static_cast<double>(stamp_ns); };
    Joint joint;
    std::int64_t stamp_ns = 0;
    const auto take = [&](std::int64_t at_ns, std::int64_t late_ns) {
        return joint.gate.take(joint.reading(at_ns, at(at_ns - late_ns))).reason;
    };
    for (; stamp_ns < 100 * period; stamp_ns += period) {
        take(stamp_ns, 0);
    }
    REQUIRE(take(stamp_ns + 1500 * us, 1400 * us) == Reason::ok); // the limits allow it
    CHECK(take(stamp_ns + 2300 * us, 0) == Reason::position_jump);
    CHECK(take(stamp_ns + 6300 * us, 0) == Reason::position_jump);
    CHECK(take(stamp_ns + 6450 * us, 2400 * us) == Reason::position_jump);
}

TEST_CASE("an encoder that returns at its zero is lost, even if the times of its readings are unknown") {
    Joint joint;
    for (int tick = 0; tick < 200; ++tick) {
        joint.take(tick, 1 - 1e-3 * (tick - 175)); // passes the zero shortly before the silence
    }
    for (int tick = 330; tick < 400; ++tick) {
        joint.glance(tick, 1 - 1e-3 * (tick - 330));
    }
    for (int tick = 400; tick < 700; ++tick) {
        CHECK(joint.take(tick, 1 - 1e-3 * (tick - 330)) == Reason::position_lost);
    }
}

TEST_CASE("after a large jump, readings are rejected until the reverse jump") {
    for (const bool back : {false, true}) {
        CAPTURE(back);
        Joint joint;
        const auto truth = [](int tick) { return 0.1 + 2e-5 * tick; };
        for (int tick = 0; tick < 200; ++tick) {
            joint.take(tick, truth(tick));
        }
        REQUIRE(joint.take(200, truth(200)) == Reason::ok);
        for (int tick = 201; tick < 320; ++tick) { // a restart, and soon a stuck bit
            CHECK(joint.take(tick, 1 + truth(tick) - truth(201) + (tick > 206 ? 0.0124 : 0)) != Reason::ok);
        }
        int trusted = 0;
        for (int tick = 320; tick < 700; ++tick) {
            const double off_rad = back ? 0 : 1 - truth(201);
            trusted += joint.take(tick, truth(tick) + off_rad) == Reason::ok ? 1 : 0;
        }
        CHECK((trusted > 100) == back);
    }
}

TEST_CASE("a joint that moves to its zero is not lost by a reading of unknown time there") {
    Joint joint;
    const auto truth = [](int tick) { return 1 + 2e-3 * (tick - 350) + 1e-3; };
    Reason last = Reason::position_lost;
    for (int tick = 0; tick < 400; ++tick) {
        if (tick == 100 || tick == 350) { // a SYNC is lost
            joint.glance(tick, truth(tick));
        } else {
            last = joint.take(tick, truth(tick));
        }
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a zero of unknown time is no evidence against later trusted readings") {
    Joint joint;
    const auto truth = [](int tick) { return 0.6 + 2e-3 * (tick - 100); };
    Reason last = Reason::position_lost;
    for (int tick = 0; tick < 400; ++tick) {
        if (tick == 100 || tick == 280) {
            joint.glance(tick, tick == 100 ? 1 : truth(tick));
        } else {
            last = joint.take(tick, truth(tick));
        }
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a joint that moves to its zero while a few readings are missing is not lost") {
    const auto truth = [](int tick) { return 1 + 2e-3 * (tick - 200) + 1e-3; };
    for (const int lost : {3, 4, 5, 7}) {
        for (const int silence : {0, 20, 100}) { // readings before the lost ones have an unknown time
            for (const bool interrupted : {false, true}) {
                CAPTURE(lost, silence, interrupted);
                Joint joint;
                Reason last = Reason::position_lost;
                for (int tick = 0; tick < 400; ++tick) {
                    if (tick < 200 && tick >= 200 - lost) {
                        continue;
                    }
                    const bool before = tick < 200 && tick >= 200 - lost - silence;
                    const bool after = tick >= 200 && tick <= 200 + silence;
                    if (after || (before && !interrupted)) {
                        joint.glance(tick, truth(tick));
                    } else if (before) {
                        joint.gate.interrupt(joint.reading(tick * period, truth(tick)));
                    } else {
                        last = joint.take(tick, truth(tick));
                    }
                }
                CHECK(last == Reason::ok);
            }
        }
    }
}

TEST_CASE("motion seen in readings of unknown time does not mark a trusted joint as frozen") {
    Joint joint;
    Reason last = Reason::position_lost;
    for (int tick = 0; tick < 800; ++tick) {
        const double to_stop = 1 - std::min(tick, 200) / 200.0;
        const double position_rad = tick < 500 ? 0.4 - 0.1 * to_stop * to_stop : 0.404;
        if (tick == 100 || tick == 101) {
            joint.glance(tick, position_rad);
        } else if (tick < 450 || tick >= 500) { // at rest, silent, and at rest close by
            last = joint.take(tick, position_rad);
        }
    }
    CHECK(last == Reason::ok);
}

TEST_CASE("a joint is trusted again after a flipped bit and a gap") {
    constexpr std::int64_t ms = 1'000'000;
    for (const double speed : {0.0, 1.0, 3.0, -3.0}) { // rad/s
        for (const int slew : {0, 8, 16}) {            // readings on the way back
            CAPTURE(speed, slew);
            Joint joint;
            joint.gate = MotionGate({.limits = {},
                                     .range = {-3, 3},
                                     .max_age_ns = 12 * ms,
                                     .period_ns = ms,
                                     .jitter_ns = 250 * us,
                                     .qualification = {.readings = 10, .zero_readings = 1000}});
            int trusted = 0;
            for (int tick = 0; tick < 1000; ++tick) {
                const int since = tick - 300;
                const double off_rad = since < 0      ? 0
                                       : since == 0   ? 0.12
                                       : since < slew ? 0.12 * (slew - since) / slew
                                                      : 0;
                if (slew == 0 && since > 0 && since <= 11) {
                    continue;
                }
                const double position_rad = 0.1 + 1e-3 * speed * (tick - 300) + off_rad;
                const bool ok = joint.gate.take(joint.reading(tick * ms, position_rad)).reason == Reason::ok;
                trusted += ok && tick >= 600 ? 1 : 0;
                CHECK_FALSE((ok && off_rad > 0.02));
            }
            CHECK(trusted == 400);
        }
    }
}

} // namespace motion_doubt_test
