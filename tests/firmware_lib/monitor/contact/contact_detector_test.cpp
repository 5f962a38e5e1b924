// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/contact_detector.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace contact_detector_test {

using Detector = dfdyn::ContactDetector<double, 2>;

constexpr std::int64_t period_ns = 2'000'000;
constexpr double period_s = 0.002;
constexpr double any = 1e6;
constexpr dfdyn::ContactLimits<double> limit{{1, 1, 1}, 0.1, 0, any, any};
constexpr dfdyn::ContactLimits<double> limits[2]{limit, limit};
constexpr double usual[2]{1, 1}; // standard deviation of the predictions

/// Function of the time in seconds.
using Signal = std::function<double(double)>;

/// A detector of two joints. The second one is stationary and has no error.
struct Arm {
    Detector detector{{}, limits};
    std::int64_t time_ns = 0;
    double deviation = 1; ///< standard deviation of the first joint's predictions
    int contacts = 0;     ///< that have begun
    double first_s = -1, last_s = -1;

    double time_s() const { return 1e-9 * static_cast<double>(time_ns); }

    void run(
        double duration_s, const Signal& position, const Signal& error,
        const Signal& prediction = [](double) { return 0; }) {
        const double end_s = time_s() + duration_s;
        while (time_s() < end_s) {
            time_ns += period_ns;
            const double q[2]{position(time_s()), 0};
            const double e[2]{error(time_s()), 0};
            const double p[2]{prediction(time_s()), 0};
            const double s[2]{deviation, 1};
            const bool before = detector.contact();
            const bool now = detector.tick(time_ns, q, e, p, s);
            contacts += now && !before ? 1 : 0;
            first_s = now && first_s < 0 ? time_s() : first_s;
            last_s = now ? time_s() : last_s;
        }
    }
};

double still(double /*t*/) { return 0; }
double moving(double t) { return 0.5 * t; }

/// Error of `size` from 2 s until `end_s`.
Signal push(double size, double end_s) {
    return [=](double t) { return t >= 2 && t < end_s ? size : 0.0; };
}

TEST_CASE("a push of twice the limit is a contact within a tenth of a second and ends with the push",
          "[contacts]") {
    const double sign = GENERATE(-1.0, 1.0);
    const Signal position = GENERATE(Signal(still), Signal(moving));
    Arm arm;
    arm.run(4, position, push(2 * sign, 2.5));
    CHECK(arm.contacts == 1);
    CHECK(arm.detector.joint() == 0);
    CHECK(arm.first_s == Approx(2.05).margin(0.05));
    CHECK(arm.last_s == Approx(2.65).margin(0.15));
    CHECK_FALSE(arm.detector.contact());
    CHECK_FALSE(arm.detector.persistent());
}

TEST_CASE("a push of up to 2.8 seconds is one contact and its end is no second one", "[contacts]") {
    const double size = GENERATE(1.3, 1.5, 2.0, 4.0);
    const double lasting_s = GENERATE(0.3, 1.0, 2.0, 2.8);
    const Signal position = GENERATE(Signal(still), Signal(moving));
    CAPTURE(size, lasting_s);
    Arm arm;
    arm.run(8, position, push(size, 2 + lasting_s));
    CHECK(arm.contacts == 1);
    CHECK(arm.last_s == Approx(2 + lasting_s + 0.2).margin(0.1));
    CHECK_FALSE(arm.detector.persistent());
}

TEST_CASE("deviations of several joints add to one contact", "[contacts]") {
    const auto contact = [](double first, double second) {
        Detector detector({}, limits);
        bool found = false;
        for (int i = 0; i < 1200; ++i) {
            const double q[2]{};
            const double e[2]{i < 1000 ? 0 : first, i < 1000 ? 0 : second};
            found = detector.tick(i * period_ns, q, e, q, usual) || found;
        }
        return found;
    };
    CHECK_FALSE(contact(0.9, 0));
    CHECK_FALSE(contact(0.5, 0.5));
    CHECK(contact(0.95, -0.95));
}

TEST_CASE("slowly changing errors of any size are no contact", "[contacts]") {
    Arm arm;
    arm.run(60, still, [](double t) { return 0.5 * t; });
    CHECK(arm.contacts == 0);
}

TEST_CASE("friction that a start, stop or reversal releases is no contact", "[contacts]") {
    // The error of a stationary joint is the torque that its friction bears; in motion the model is accurate.
    const double borne = GENERATE(-5.0, 5.0);
    Arm arm;
    arm.run(10, still, [borne](double t) { return borne * std::min(t / 8, 1.0); });
    arm.run(
        0.02, [](double t) { return 0.5 * (t - 10); }, [borne](double) { return borne; });
    arm.run(
        5, [](double t) { return 0.5 * (t - 10); }, still);
    CHECK(arm.contacts == 0);
}

TEST_CASE("a persistent error is accepted as a change of the arm after three seconds, once", "[contacts]") {
    // Larger than what the baseline follows in three seconds.
    Arm arm;
    arm.run(20, still, push(8, 20));
    CHECK(arm.contacts == 1);
    CHECK(arm.detector.persistent());
    CHECK(arm.last_s == Approx(2 + Detector::longest_s).margin(0.1));
}

TEST_CASE("noise and a hundred pushes in it do not raise the limits of an arm", "[contacts]") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> noise(0, 0.1);
    const auto period = GENERATE(5.0, 50.0);
    const auto pushed = [period](double t) { return t > 2 && std::fmod(t, period) < 0.5; };
    Arm arm; // pushes at period, 2 period, ... below 500 s
    arm.run(500, moving, [&](double t) { return noise(engine) + (pushed(t) ? 2 : 0); });
    CHECK(arm.contacts == std::lround(500 / period) - 1); // none in the first 2 s
}

/// A detector of one joint that has these limits.
struct LimitedArm {
    dfdyn::ContactLimits<double> limits[2];
    Arm arm;

    LimitedArm(double relative, double acceleration)
        : limits{{{1, 1, 1}, 0.1, relative, any, acceleration}, limit}, arm{{{}, limits}} {}
};

TEST_CASE("an error in the usual proportion to a change of the prediction is no contact", "[contacts]") {
    const auto contacts = [](double relative) {
        LimitedArm one(relative, any);
        const auto jump = [](double t) { return t < 2 ? 0.0 : 4.0; };
        one.arm.run(
            6, moving, [&](double t) { return 0.4 * jump(t); }, jump);
        return one.arm.contacts;
    };
    CHECK(contacts(0) == 1);
    CHECK(contacts(0.5) == 0);
    LimitedArm pushed(0.5, any); // long after the change
    pushed.arm.run(
        9, moving, [](double t) { return t < 7 ? 0.0 : 1.6; }, [](double t) { return t < 2 ? 0.0 : 4.0; });
    CHECK(pushed.arm.contacts == 1);
}

TEST_CASE("an error that the prediction's standard deviation announces is no contact", "[contacts]") {
    const double deviation = GENERATE(0.5, 1.0);
    LimitedArm one(0, any);
    one.limits[0].standard_deviation = 0.5;
    one.arm.deviation = deviation;
    one.arm.run(4, moving, push(1.3, 2.5));
    CHECK(one.arm.contacts == (deviation > 0.5 ? 0 : 1));
}

TEST_CASE("an error at an acceleration far above those of the training is no contact, later it is one",
          "[contacts]") {
    const auto contacts = [](double usual_acceleration, double at_s) {
        LimitedArm one(0, usual_acceleration);
        // 0.1 s of 10 rad/s²
        const auto position = [](double t) {
            const double since = std::clamp(t - 3, 0.0, 0.1);
            return 0.5 * t + 5 * since * since + (t > 3.1 ? t - 3.1 : 0.0);
        };
        one.arm.run(6, position, [=](double t) { return t >= at_s && t < at_s + 0.3 ? 2.0 : 0.0; });
        return one.arm.contacts;
    };
    CHECK(contacts(20, 3.03) == 1);
    CHECK(contacts(1, 3.03) == 0);
    CHECK(contacts(1, 5) == 1);
}

TEST_CASE("a jump of an encoder hides contacts for a second only", "[contacts]") {
    LimitedArm one(0, 1);
    one.arm.run(
        5, [](double t) { return t >= 2 && t < 2.002 ? 0.9 * Detector::largest_position : 0.0; },
        [](double t) { return t >= 3.2 && t < 3.6 ? 3.0 : 0.0; });
    CHECK(one.arm.contacts == 1);
    CHECK(one.arm.first_s == Approx(3.25).margin(0.05));
}

TEST_CASE("a position too large to be one leaves no velocity behind", "[contacts]") {
    const double huge = GENERATE(1e308, -1e308, 1.1 * Detector::largest_position);
    CAPTURE(huge);
    Arm arm;
    arm.run(
        2, [huge](double t) { return t >= 1 && t < 1.002 ? huge : 0.0; }, still);
    CHECK(arm.detector.speed(0) == 0);
    CHECK(arm.detector.motion(0) == dfdyn::JointMotion::standing);
    arm.run(2, still, push(2, 2.5));
    CHECK(arm.contacts == 1);
}

TEST_CASE("stamps that jump from the latest to the earliest one end a contact", "[contacts]") {
    using Stamps = std::numeric_limits<std::int64_t>;
    constexpr int before = 1000, ticks = 1100;
    Detector detector({}, limits);
    const double zero[2]{};
    const double pushed[2]{2, 0};
    for (int i = 1; i <= ticks; ++i) {
        detector.tick(Stamps::max() - (ticks - i) * period_ns, zero, i <= before ? zero : pushed, zero,
                      usual);
    }
    REQUIRE(detector.contact());
    CHECK_FALSE(detector.tick(Stamps::min(), zero, pushed, zero, usual));
}

TEST_CASE("samples inform about an arm in motion and not about one at rest or pushed", "[contacts]") {
    const Arm unknown;
    CHECK(unknown.detector.informative());
    Arm rests;
    rests.run(1, still, still);
    CHECK_FALSE(rests.detector.informative());
    Arm moves;
    moves.run(2, moving, still);
    CHECK(moves.detector.informative());
    moves.run(0.3, moving, push(2, 4));
    CHECK(moves.detector.contact());
    CHECK_FALSE(moves.detector.informative());
}

TEST_CASE("a contact is found although every 20th tick has no sample", "[contacts]") {
    Detector detector({}, limits);
    const double zero[2]{};
    const double pushed[2]{2, 0};
    int found = 0; // tick
    for (int i = 1; i <= 1500; ++i) {
        const std::int64_t time_ns = i * period_ns;
        if (i % 20 == 0) {
            detector.skip(time_ns);
        } else if (detector.tick(time_ns, zero, i < 1000 ? zero : pushed, zero, usual) && found == 0) {
            found = i;
        }
    }
    CHECK(found > 1000);
    CHECK(found < 1050);
}

TEST_CASE("a contact stays for a tenth of a second without samples and then ends", "[contacts]") {
    Detector detector({}, limits);
    const double zero[2]{};
    const double pushed[2]{2, 0};
    std::int64_t time_ns = 0;
    const auto detect = [&] {
        for (int i = 0; i < 1100; ++i) {
            detector.tick(time_ns += period_ns, zero, i < 1000 ? zero : pushed, zero, usual);
        }
        return detector.contact();
    };
    REQUIRE(detect());
    for (int i = 0; i < 49; ++i) {
        detector.skip(time_ns += period_ns);
    }
    CHECK(detector.contact());
    detector.skip(time_ns += 2 * period_ns);
    CHECK_FALSE(detector.contact());
    CHECK_FALSE(detector.suspected());
    CHECK_FALSE(detector.running());
    REQUIRE(detect());
    detector.skip(time_ns - 1); // the clock was set back: the gap is unknown
    CHECK_FALSE(detector.contact());
}

TEST_CASE("a second push is a contact of its own if the error of the model remains between them",
          "[contacts]") {
    const double sign = GENERATE(-1.0, 1.0);
    Arm arm;
    arm.run(6, moving, [sign](double t) {
        const bool pushed = (t >= 2 && t < 2.4) || (t >= 3.2 && t < 3.6);
        return t < 2 ? 0.0 : sign * (pushed ? 4.0 : 1.3);
    });
    CHECK(arm.contacts == 2);
}

TEST_CASE("samples that are read twice neither hide a push nor end it", "[contacts]") {
    const bool skipped = GENERATE(false, true); // as by an estimator that refuses a repeated stamp
    CAPTURE(skipped);
    Arm arm;
    const double q[2]{};
    while (arm.time_s() < 4) {
        arm.run(0.5e-9 * period_ns, still, push(2, 2.5)); // one tick
        if (skipped) {
            arm.detector.skip(arm.time_ns);
        } else {
            CHECK(arm.detector.tick(arm.time_ns, q, q, q, usual) == arm.detector.contact());
        }
    }
    CHECK(arm.contacts == 1);
    CHECK(arm.first_s == Approx(2.05).margin(0.05));
}

TEST_CASE("a stamp that does not advance any more ends a contact", "[contacts]") {
    Arm arm;
    arm.run(2.2, still, push(2, 2.5));
    REQUIRE(arm.detector.contact());
    const double q[2]{};
    for (int t = 0; t < Detector::most_repeats; ++t) {
        CHECK(arm.detector.tick(arm.time_ns, q, q, q, usual));
    }
    CHECK_FALSE(arm.detector.tick(arm.time_ns, q, q, q, usual));
    CHECK_FALSE(arm.detector.running());
}

TEST_CASE("non-finite values and wrong stamps neither cause a contact nor disable the detector",
          "[contacts]") {
    using Limits = std::numeric_limits<double>;
    for (const double bad : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
        CAPTURE(bad);
        Arm arm;
        arm.run(2, still, still);
        const double q[2]{};
        const double e[2]{bad, 0};
        CHECK_FALSE(arm.detector.tick(arm.time_ns + period_ns, q, e, q, usual));
        CHECK_FALSE(arm.detector.tick(arm.time_ns + period_ns, q, q, e, usual));
        CHECK_FALSE(arm.detector.tick(arm.time_ns + period_ns, e, q, q, usual));
        CHECK_FALSE(arm.detector.running());
        arm.time_ns += 10'000'000'000; // a gap
        const double start_s = arm.time_s();
        arm.run(3, still, [start_s](double t) { return t >= start_s + 1 && t < start_s + 1.5 ? 2.0 : 0.0; });
        CHECK(arm.contacts == 1);
        CHECK(arm.first_s == Approx(start_s + 1.05).margin(0.05));
        CHECK_FALSE(arm.detector.tick(arm.time_ns, q, q, q, usual));     // the same stamp again
        CHECK_FALSE(arm.detector.tick(arm.time_ns - 5, q, q, q, usual)); // back
    }
}

} // namespace contact_detector_test
