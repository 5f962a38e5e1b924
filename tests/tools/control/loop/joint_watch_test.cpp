// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/joint_watch.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace joint_watch_test {

using namespace dfdyn::tools;

constexpr double period_s = 0.002, quantum = 1e-4, sticking = 0.005;

SafeStopConfig limits() {
    SafeStopConfig config;
    config.following_error = JointVector::Constant(1, 0.1);
    config.sticking = JointVector::Constant(1, sticking);
    config.speed_limit = JointVector::Constant(1, 2);
    config.torque_limit = JointVector::Constant(1, 50);
    config.acceleration = JointVector::Constant(1, 100);
    config.pressing_ticks = 20;
    return config;
}

/// A joint whose readings are whole quanta, with the watch that checks them.
class Joint {
  public:
    StopCause tick(double position, double reference, double command = 0) {
        const JointVector reading =
            JointVector::Constant(1, offset + quantum * std::round(position / quantum));
        const Reference target{JointVector::Constant(1, reference), JointVector::Zero(1),
                               JointVector::Zero(1)};
        feedback_.advance();
        watch.read(reading, target.position, feedback_, {missing});
        const std::vector<bool> unused{missing || watch.repeated()[0]};
        feedback_.observe(ticks_ago, reading, target, &unused);
        if (feedback_.position().size() > 0) {
            watch.move(feedback_, JointVector::Constant(1, command));
        }
        return watch.cause();
    }
    StopCause tick(double position) { return tick(position, position); }

    double offset = 0;    ///< of the encoder
    bool missing = false; ///< no reading in this tick
    int ticks_ago = 0;    ///< age of the readings
    JointWatch watch{limits(), period_s};

  private:
    static DerivativeModel filter() {
        DerivativeModel model;
        model.noise_bound = quantum;
        return model;
    }
    PositionFeedback feedback_{
        {JointVector::Constant(1, 900), JointVector::Constant(1, 90)}, filter(), period_s};
};

TEST_CASE("an encoder that freezes on a moving joint is detected at the fifth equal reading") {
    for (const double speed : {0.5, 1.0, -1.8}) {
        CAPTURE(speed);
        Joint joint;
        double position = 0;
        for (int tick = 0; tick <= 100; ++tick) { // from rest, as every motion begins
            position += speed * tick / 100 * period_s;
            REQUIRE(joint.tick(position) == StopCause::none);
        }
        for (int reading = 1; reading < 5; ++reading) {
            CHECK(joint.tick(position, position + speed * period_s * reading) == StopCause::none);
            CHECK(joint.watch.repeated()[0]);
        }
        CHECK(joint.tick(position, position + speed * period_s * 5) == StopCause::frozen_encoder);
    }
}

TEST_CASE("an encoder that freezes on a joint at rest is detected once friction cannot hold the joint") {
    Joint joint;
    double reference = 0;
    int late = 0;
    while (joint.tick(0, reference) == StopCause::none) {
        reference += 0.2 * period_s;
        late += reference > sticking ? 1 : 0;
        REQUIRE(late <= 6);
    }
    CHECK(joint.watch.cause() == StopCause::frozen_encoder);
    CHECK(reference > sticking);
}

TEST_CASE("a joint that rests or stops abruptly or creeps is not reported as frozen") {
    Joint standing;
    for (int tick = 0; tick < 1000; ++tick) {
        CHECK(standing.tick(0.3) == StopCause::none);
    }
    Joint braking; // decelerates with 12 rad/s² from 1.5 rad/s
    double speed = 1.5, position = 0;
    for (int tick = 0; tick < 300; ++tick) {
        speed = tick < 50 ? speed : std::max(0.0, speed - 12 * period_s);
        position += speed * period_s;
        CHECK(braking.tick(position) == StopCause::none);
    }
    Joint creeping; // one quantum every 8 readings
    for (int tick = 0; tick < 2000; ++tick) {
        CHECK(creeping.tick(quantum / 8 * tick) == StopCause::none);
    }
}

TEST_CASE("a joint that vibrates and then sticks is not reported as frozen") {
    constexpr double amplitude = 10 * quantum, frequency_hz = 50;
    for (int last = 200; last < 210; ++last) { // all phases of a period of ten readings
        CAPTURE(last);
        Joint joint;
        for (int tick = 0; tick <= last + 20; ++tick) {
            const double time_s = period_s * std::min(tick, last);
            const double position = amplitude * std::sin(2 * std::numbers::pi * frequency_hz * time_s);
            CHECK(joint.tick(position, 0) == StopCause::none);
        }
    }
}

TEST_CASE("an encoder's count is the smallest step of its readings, without the first one") {
    constexpr double speed = 0.12; // rad/s, from which the joint can stop within six counts
    Joint joint;
    joint.offset = quantum / 20;
    joint.missing = true;
    CHECK(joint.tick(0) == StopCause::none);
    joint.missing = false;
    double position = 0;
    for (int tick = 0; tick < 100; ++tick) {
        position = speed * period_s * tick;
        CHECK(joint.tick(position) == StopCause::none);
    }
    for (int reading = 0; reading < 20; ++reading) {
        CHECK(joint.tick(position) == StopCause::none);
    }
}

TEST_CASE("overspeed needs three readings after the filter's lag and one wrong reading is not enough") {
    Joint joint;
    for (int tick = 0; tick < 50; ++tick) {
        REQUIRE(joint.tick(1.9 * period_s * tick + (tick == 30 ? 0.01 : 0)) == StopCause::none);
    }
    int readings = 0;
    double position = 1.9 * period_s * 49;
    do {
        position += 2.2 * period_s;
        ++readings;
    } while (joint.tick(position) == StopCause::none);
    CHECK(joint.watch.cause() == StopCause::overspeed);
    CHECK(readings <= 12); // the lag of the filter plus three readings
}

TEST_CASE("overspeed is detected from readings that are a tick old") {
    Joint joint;
    joint.ticks_ago = 1;
    for (int tick = 0; tick < 50; ++tick) {
        REQUIRE(joint.tick(1.9 * period_s * tick) == StopCause::none);
    }
    StopCause cause = StopCause::none;
    for (int reading = 1; reading <= 12; ++reading) {
        cause = joint.tick(1.9 * period_s * 49 + 2.2 * period_s * reading);
    }
    CHECK(cause == StopCause::overspeed);
}

TEST_CASE("a joint that presses at its torque limit without moving stops and one that moves does not") {
    Joint moving;
    for (int tick = 0; tick < 100; ++tick) {
        CHECK(moving.tick(0.8 * period_s * tick, 0.8 * period_s * tick, 50) == StopCause::none);
    }
    Joint pressing;
    for (int tick = 0; tick < 20; ++tick) {
        CHECK(pressing.tick(0.001 * (tick % 3), 0, -50) == StopCause::none);
    }
    CHECK(pressing.tick(0, 0, -50) == StopCause::torque_limit);
}

TEST_CASE("a reference moved to a joint at rest is no frozen encoder") {
    Joint joint;
    for (int tick = 0; tick < 50; ++tick) {
        REQUIRE(joint.tick(0.1, 0.05) == StopCause::none);
    }
    joint.watch.move_reference(JointVector::Constant(1, 0.05));
    for (int tick = 0; tick < 50; ++tick) {
        REQUIRE(joint.tick(0.1, 0.1) == StopCause::none);
    }
}

} // namespace joint_watch_test
