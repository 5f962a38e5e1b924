// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/position_feedback.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <vector>

namespace position_feedback_test {

using namespace dfdyn::tools;

constexpr double period_s = 0.002, speed = 1.5, kp = 900, kd = 90;

PositionFeedback feedback(double noise_bound = 1e-6, double acceleration = 100, int velocity_window = 10) {
    DerivativeModel filter;
    filter.velocity_window = velocity_window;
    filter.noise_bound = noise_bound;
    return {{JointVector::Constant(2, kp), JointVector::Constant(2, kd)},
            filter,
            period_s,
            {JointVector::Constant(2, 3), JointVector::Constant(2, acceleration)}};
}

/// Both joints follow a reference of constant speed and lag 0.01 rad behind it.
Reference reference(int tick) {
    return {JointVector::Constant(2, speed * period_s * tick), JointVector::Constant(2, speed),
            JointVector::Zero(2)};
}
JointVector position(int tick) { return reference(tick).position.array() - 0.01; }

PositionFeedback after(int ticks, int velocity_window = 10) {
    PositionFeedback result = feedback(1e-6, 100, velocity_window);
    for (int tick = 0; tick < ticks; ++tick) {
        result.advance();
        result.observe(0, position(tick), reference(tick));
    }
    return result;
}

TEST_CASE("the velocity after lost readings is the average over the gap") {
    PositionFeedback loop = after(20);
    for (int tick = 20; tick < 23; ++tick) {
        loop.advance(); // no reading arrives
    }
    loop.advance();
    loop.observe(0, position(23), reference(23));
    CHECK(loop.velocity()[0] == Approx(speed));
    CHECK_FALSE(loop.regular());
    loop.advance();
    loop.observe(0, position(24), reference(24));
    CHECK(loop.velocity()[0] == Approx(speed));
    CHECK(loop.regular());
}

TEST_CASE("the silent joint is the one without the readings that others have") {
    PositionFeedback loop = after(20);
    CHECK_FALSE(loop.silent_joint().has_value());
    const std::vector<bool> second{false, true};
    for (int tick = 20; tick < 25; ++tick) {
        loop.advance();
        loop.observe(0, position(tick), reference(tick), &second);
        CHECK(loop.silent_joint() == 1);
    }
    for (int tick = 25; tick < 30; ++tick) {
        loop.advance(); // the other one falls silent, too
        CHECK_FALSE(loop.silent_joint().has_value());
    }
}

TEST_CASE("the motion is known over two lost readings and not beyond or after an impossible one") {
    PositionFeedback loop = after(20);
    CHECK(loop.known());
    for (int tick = 20; tick < 23; ++tick) {
        loop.advance();
        CHECK(loop.known() == (tick < 22));
    }
    loop.advance();
    loop.observe(0, position(23), reference(23));
    CHECK(loop.known());
    loop.advance();
    loop.observe(0, position(24).array() + 0.1, reference(24));
    CHECK_FALSE(loop.known());
}

TEST_CASE("a noise bound of half an encoder's count, or of none, causes no peaks of the velocity") {
    const double share = GENERATE(0.5, 0.0);
    CAPTURE(share);
    constexpr double fine = 1e-4, count = 4e-4, slow = 0.75, tick_s = 0.001; // rad, rad/s, s
    DerivativeModel filter;
    filter.velocity_window = 20;
    filter.noise_bound = share * count;
    PositionFeedback loop({JointVector::Constant(1, kp), JointVector::Constant(1, kd)}, filter, tick_s,
                          {JointVector::Constant(1, 10), JointVector::Constant(1, 30)});
    const auto rounded = [](double value, double step) { return step * std::round(value / step); };
    for (int tick = 0; tick < 10000; ++tick) {
        const double time_s = tick_s * tick;
        const double velocity = slow * std::sin(time_s);
        const double truth = slow * (1 - std::cos(time_s));
        const JointVector reading = JointVector::Constant(1, rounded(rounded(truth, fine), count));
        loop.advance();
        loop.observe(0, reading, {JointVector::Constant(1, truth), JointVector::Constant(1, velocity), {}});
        if (tick > 10) {
            REQUIRE(loop.velocity()[0] == Approx(velocity).margin(0.06));
            REQUIRE((loop.regular() || tick < 100)); // a count is no jump
        }
    }
}

TEST_CASE("an older reading gives the torque of the present tick whatever its age") {
    for (const int age : {1, 2, 5}) {
        PositionFeedback loop = after(20);
        const double before = loop.torque()[0];
        for (int tick = 20; tick < 25; ++tick) {
            loop.advance();
        }
        loop.observe(age, position(24 - age), reference(24 - age));
        CHECK(loop.velocity()[0] == Approx(speed));
        CHECK(loop.age(0) == age);
        CHECK(loop.torque()[0] == Approx(before).epsilon(1e-9));
        CHECK(loop.error()[0] == Approx(0.01));
    }
}

TEST_CASE("without readings the torque stays constant because the tracking error is assumed to be constant") {
    PositionFeedback loop = after(20);
    const double before = loop.torque()[0];
    for (int tick = 20; tick < 60; ++tick) {
        loop.advance();
        CHECK(loop.torque()[0] == Approx(before).epsilon(1e-9));
        CHECK_FALSE(loop.complete());
    }
}

TEST_CASE("a changing error is extrapolated for a bounded time with at most the joint's speed limit") {
    for (const double rate : {0.1, -20.0}) {
        CAPTURE(rate);
        PositionFeedback loop = after(20);
        JointVector where = position(19);
        for (int tick = 20; tick < 22; ++tick) {
            loop.advance();
            where += JointVector::Constant(2, (speed - rate) * period_s);
            loop.observe(0, where, reference(tick));
        }
        const double start = loop.error()[0];
        for (int tick = 0; tick < 100; ++tick) {
            loop.advance();
        }
        const double bounded = std::clamp(rate, -3.0, 3.0);
        CHECK(loop.error()[0] - start ==
              Approx(bounded * period_s * PositionFeedback::fade_ticks / 2).epsilon(1e-6));
    }
}

TEST_CASE("only the joint without a reading is extrapolated") {
    PositionFeedback loop = after(20);
    const double before = loop.torque()[1];
    loop.advance();
    JointVector odd = position(20);
    odd[1] += 1;
    const std::vector<bool> missing{false, true};
    loop.observe(0, odd, reference(20), &missing);
    CHECK(loop.age(0) == 0);
    CHECK(loop.age(1) == 1);
    CHECK(loop.torque()[1] == Approx(before).epsilon(1e-9));
    CHECK_FALSE(loop.complete());
}

TEST_CASE("a reading that would need an impossible acceleration is reported as irregular") {
    PositionFeedback loop = after(20);
    loop.advance();
    // An acceleration of 100 rad/s² moves a joint by 0.0004 rad in 2 ms.
    loop.observe(0, position(20).array() + 0.0003, reference(20));
    CHECK(loop.regular());
    loop.advance();
    loop.observe(0, position(21).array() + 0.01, reference(21));
    CHECK_FALSE(loop.regular());
}

TEST_CASE("a jump is not believed until it has lasted, also with a velocity window of two readings") {
    const int window = GENERATE(2, 10), length = GENERATE(1, 2, 3);
    CAPTURE(window, length);
    PositionFeedback loop = after(20, window);
    for (int tick = 20; tick < 20 + length; ++tick) {
        loop.advance();
        JointVector jumped = position(tick);
        jumped[1] += 0.6;
        loop.observe(0, jumped, reference(tick));
        CHECK(loop.settled(0));
        CHECK(loop.settled(1) == (tick == 22));
        const double expected = position(tick)[1] + (tick == 22 ? 0.6 : 0);
        CHECK(loop.believed_motion(1).position == Approx(expected).margin(1e-9));
        CHECK(loop.believed_motion(1).velocity == Approx(speed).epsilon(1e-6));
    }
    if (length < 3) {
        loop.advance();
        loop.observe(0, position(20 + length), reference(20 + length));
        CHECK(loop.settled(1));
        CHECK(loop.believed_motion(1).position == Approx(position(20 + length)[1]));
        CHECK(loop.believed_motion(1).velocity == Approx(speed));
    }
}

TEST_CASE("wrong readings that contradict each other are not believed") {
    PositionFeedback loop = after(20);
    const double jumps[]{0.6, -0.4, 0.9, -0.7, 0.3};
    for (int tick = 20; tick < 25; ++tick) {
        loop.advance();
        JointVector reading = position(tick);
        reading[0] += jumps[tick - 20];
        loop.observe(0, reading, reference(tick));
        CHECK_FALSE(loop.settled(0));
        CHECK_FALSE(loop.regular(0));
        CHECK(loop.believed_motion(0).position == Approx(position(tick)[0]));
    }
}

TEST_CASE("a moving joint does not jump when its reference comes to rest at once") {
    PositionFeedback loop = after(20); // 1.5 rad/s, with an acceleration of at most 100 rad/s²
    const Reference rest{reference(19).position, JointVector::Zero(2), JointVector::Zero(2)};
    loop.hold_reference(rest.position);
    for (int tick = 20; tick < 24; ++tick) {
        loop.advance();
        loop.observe(0, position(tick), rest);
        CHECK(loop.settled(0));
        CHECK(loop.regular(0));
        CHECK(loop.believed_motion(0).position == Approx(position(tick)[0]));
    }
}

TEST_CASE("of two wrong readings with a right one between them neither is believed") {
    PositionFeedback loop = after(20);
    for (int tick = 20; tick < 23; ++tick) {
        loop.advance();
        JointVector reading = position(tick);
        reading[0] += tick == 21 ? 0 : 0.6;
        loop.observe(0, reading, reference(tick));
        CHECK(loop.settled(0) == (tick == 21));
        CHECK(loop.believed_motion(0).position == Approx(position(tick)[0]));
    }
}

TEST_CASE("one or two rounded readings beside the others hardly change the velocity") {
    const int beside = GENERATE(1, 2);
    CAPTURE(beside);
    constexpr double count = 4e-4, glitch = 0.03;
    PositionFeedback loop = feedback(count, 20);
    for (int tick = 0; tick < 40; ++tick) {
        JointVector where = position(tick);
        where[0] += tick == 20 ? glitch : tick == 21 && beside == 2 ? glitch - count : 0;
        loop.advance();
        loop.observe(0, where, reference(tick));
        CAPTURE(tick);
        CHECK((tick < 2 || std::abs(loop.velocity()[0] - speed) < 0.1)); // two readings alone: 0.2
    }
}

TEST_CASE("a moved reference does not count as a jump of the reading") {
    PositionFeedback loop = after(20);
    const double rate = loop.error_rate()[0];
    const JointVector distance = JointVector::Constant(2, 0.3);
    loop.move_reference(distance);
    CHECK(loop.error()[0] == Approx(0.31));
    Reference moved = reference(20);
    moved.position += distance;
    loop.advance();
    loop.observe(0, position(20), moved);
    CHECK(loop.regular());
    CHECK(loop.error()[0] == Approx(0.31));
    CHECK(loop.error_rate()[0] == Approx(rate).margin(1e-9));
}

} // namespace position_feedback_test
