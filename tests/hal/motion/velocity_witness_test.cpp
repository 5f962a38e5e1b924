// SPDX-License-Identifier: Apache-2.0
// Positions that no limit of the motion excludes, and the velocities in the same frames.
#include "dfdyn/hal/motion/velocity_witness.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <random>

namespace velocity_witness_test {

using dfdyn::hal::JointValue;
using dfdyn::hal::VelocityWitness;

constexpr double period_s = 2e-3;

/// A joint that moves, and rests for a second every four.
struct Joint {
    double angle = 0.3, speed = 0;

    void step(int tick) {
        const double time_s = period_s * tick;
        speed = std::fmod(time_s, 4) < 1 ? 0 : std::sin(1.7 * time_s) + 0.3 * std::sin(5 * time_s);
        angle += period_s * speed;
    }
};

JointValue value_of(int tick, double position_rad, double velocity, double step_rad = 1e-4) {
    JointValue value;
    value.stamp_ns = std::llround(1e9 * period_s * tick);
    value.position_rad = step_rad * std::round(position_rad / step_rad);
    value.step_rad = step_rad;
    value.has_velocity = true;
    value.velocity = velocity;
    return value;
}

TEST_CASE("velocities that lag, are coarse, have an offset or jump do not contradict the position") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> noise(0, 0.05);
    std::bernoulli_distribution flips(0.002);
    for (const double step_rad : {1e-5, 1.5e-3, 6e-3}) {
        VelocityWitness witness;
        Joint joint;
        double lagging = 0;
        for (int tick = 0; tick < 60'000; ++tick) {
            joint.step(tick);
            lagging += period_s / 0.02 * (joint.speed - lagging);
            const double coarse = 0.015 * std::round(1.1 * lagging / 0.015) + 0.015;
            const double sent = flips(engine) ? 30 : coarse + noise(engine);
            CAPTURE(step_rad, tick);
            REQUIRE_FALSE(witness.contradicts(value_of(tick, joint.angle, sent, step_rad)));
        }
    }
}

/// Largest error (rad) of a position that was not contradicted, if `position` is sent from 20 s to 30 s, and
/// whether the joint is contradicted ten seconds later.
struct Found {
    double error_rad = 0;
    bool at_the_end = false;
};
template <class Position>
Found found(Position position) {
    VelocityWitness witness;
    Joint joint;
    Found result;
    for (int tick = 0; tick < 20'000; ++tick) {
        joint.step(tick);
        const double time_s = period_s * tick;
        const double sent_rad = time_s < 20 || time_s > 30 ? joint.angle : position(joint, time_s);
        result.at_the_end = witness.contradicts(value_of(tick, sent_rad, joint.speed));
        if (!result.at_the_end) {
            result.error_rad = std::max(result.error_rad, std::abs(sent_rad - joint.angle));
        }
    }
    return result;
}

TEST_CASE("an encoder that freezes at rest is found within 0.1 rad, and trusted again later") {
    double frozen_rad = 0;
    const Found result = found([&](const Joint& joint, double time_s) {
        frozen_rad = time_s < 20.5 ? joint.angle : frozen_rad; // at rest
        return frozen_rad;
    });
    CHECK(result.error_rad < 0.1);
    CHECK_FALSE(result.at_the_end);
}

TEST_CASE("a position that drifts, or has half the scale or the other sign, is found within 0.3 rad") {
    double begin_rad = 0;
    const auto of_scale = [&](double scale) {
        return found([&begin_rad, scale](const Joint& joint, double time_s) {
            begin_rad = time_s < 20.5 ? joint.angle : begin_rad; // at rest
            return begin_rad + scale * (joint.angle - begin_rad);
        });
    };
    for (const double scale : {0.5, 2.0, -1.0}) {
        CAPTURE(scale);
        CHECK(of_scale(scale).error_rad < 0.3);
        CHECK_FALSE(of_scale(scale).at_the_end);
    }
    CHECK(of_scale(1).error_rad == 0);
    CHECK(found([](const Joint& joint, double time_s) {
              return joint.angle + 0.5 * (time_s - 20);
          }).error_rad < 0.3);
}

TEST_CASE("a velocity that never agreed with the position is no evidence") {
    for (const double scale : {0.0, 0.6, 1.6, -1.0, 9.55}) { // such as revolutions instead of radians
        VelocityWitness witness;
        Joint joint;
        for (int tick = 0; tick < 20'000; ++tick) {
            joint.step(tick);
            CAPTURE(scale, tick);
            REQUIRE_FALSE(witness.contradicts(value_of(tick, joint.angle, scale * joint.speed)));
        }
    }
}

TEST_CASE("a contradiction ends after 2 s without velocities, and a later velocity must agree again") {
    VelocityWitness witness;
    Joint joint;
    int tick = 0;
    double sent_rad = 0;
    bool contradicted = false;
    for (; tick < 12'000; ++tick) {
        joint.step(tick);
        sent_rad = tick < 10'250 ? joint.angle : sent_rad; // freezes at rest
        contradicted = witness.contradicts(value_of(tick, sent_rad, joint.speed));
    }
    REQUIRE(contradicted);
    for (; tick < 17'000; ++tick) {
        joint.step(tick);
        JointValue value = value_of(tick, joint.angle, 0);
        value.has_velocity = false;
        CAPTURE(tick);
        CHECK(witness.contradicts(value) == (tick <= 12'999)); // the last velocity was at 11'999
    }
    for (; tick < 22'000; ++tick) {
        joint.step(tick);
        CHECK_FALSE(witness.contradicts(value_of(tick, joint.angle, 0.5 * joint.speed)));
    }
}

TEST_CASE("a single jump, a silence and a value without velocity contradict nothing") {
    VelocityWitness witness;
    Joint joint;
    for (int tick = 0; tick < 20'000; ++tick) {
        joint.step(tick);
        const double offset_rad = tick > 10'000 ? 1 : 0;
        JointValue value = value_of(tick, joint.angle + offset_rad, joint.speed);
        value.has_velocity = tick % 1000 != 0;
        CAPTURE(tick);
        REQUIRE_FALSE((tick % 3000 > 200 && witness.contradicts(value)));
    }
}

} // namespace velocity_witness_test
