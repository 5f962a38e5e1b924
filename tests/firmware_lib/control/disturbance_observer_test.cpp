// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/control/disturbance_observer.hpp"

#include "tests/firmware_lib/control/joint.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

namespace disturbance_observer_test {

using namespace dfdyn;
using namespace dfdyn::tests;

using Observer = DisturbanceObserver<double, 1>;
constexpr double none = 0;
constexpr double step_s = 1e-5;
constexpr JointLoop<double> joint_loop{1.5, 500, 60, 0, 0};
constexpr double bandwidth = 40;
constexpr double unlimited = std::numeric_limits<double>::infinity();

/// e(t) of (J s² + D s + P)(s + b) e = s · disturbance for a step of 1 N·m: the sum of three exponentials of
/// the partial fractions.
double error_after_step(double t) {
    const auto [inertia, stiffness, damping, delay, other_delay] = joint_loop;
    const double centre = damping / (2 * inertia);
    const double spread = std::sqrt(centre * centre - stiffness / inertia);
    const double poles[] = {-centre + spread, -centre - spread, -bandwidth};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const double others = (poles[i] - poles[(i + 1) % 3]) * (poles[i] - poles[(i + 2) % 3]);
        sum += std::exp(poles[i] * t) / (others * inertia);
    }
    return sum;
}

TEST_CASE("after a torque step the error has the feedback's poles and one at the bandwidth") {
    ServoJoint joint(joint_loop, step_s);
    Observer observer({}, {step_s, {{bandwidth}}, {{100}}, {{unlimited}}, {{unlimited}}});
    double largest = 0;
    double worst = 0;
    for (int i = 0; i < 100'000; ++i) {
        const double feedback = joint.feedback();
        const double rate = joint.error_rate();
        const double estimate = observer.update(&feedback, &joint_loop.inertia, &rate, &none)[0];
        joint.advance(feedback + estimate - 1);
        const double truth = error_after_step(step_s * (i + 1));
        largest = std::max(largest, truth);
        worst = std::max(worst, std::abs(-joint.position() - truth));
    }
    CHECK(worst < 0.01 * largest);
    CHECK(observer.estimate()[0] == Approx(1).epsilon(1e-3));
    CHECK(std::abs(joint.position()) < 1e-3 * largest);
}

TEST_CASE("an estimate stays within its limit and does not wind up at the command's limit") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> size(0, 50);
    Observer observer({}, {1e-3, {{bandwidth}}, {{3}}, {{unlimited}}, {{unlimited}}});
    for (int i = 0; i < 10'000; ++i) {
        const double feedback = size(engine);
        const double rate = size(engine);
        const double inertia = std::abs(size(engine));
        REQUIRE(std::abs(observer.update(&feedback, &inertia, &rate, &none)[0]) <= 3);
    }
    observer.restart();
    constexpr double push = 20;
    constexpr double excess = 1;
    for (int i = 0; i < 1000; ++i) {
        observer.update(&push, &none, &none, &excess);
    }
    CHECK(observer.estimate()[0] == 0);
    const double back = -push;
    observer.update(&back, &none, &none, &excess); // inside the limit it may change
    CHECK(observer.estimate()[0] < 0);
}

/// Slope (N·m/s) and largest change of the estimate for a constant feedback of 1 N·m and a rate rounded to
/// multiples of `count`, 0.01 rad/s on average.
struct Rounded {
    double slope, change;
};
Rounded after_rounding(double count, double step) {
    constexpr double period = 1e-3, feedback = 1, inertia = 1.5;
    Observer observer({}, {period, {{bandwidth}}, {{1e6}}, {{step}}, {{unlimited}}});
    Rounded result{0, 0};
    double at_1_s = 0;
    for (int tick = 0; tick < 5000; ++tick) {
        const double rate = count * (std::floor((tick + 1) * 0.01 / count) - std::floor(tick * 0.01 / count));
        const double before = observer.estimate()[0];
        const double after = observer.update(&feedback, &inertia, &rate, &none)[0];
        at_1_s = tick < 1000 ? after : at_1_s;
        result.change = std::max(result.change, tick > 1000 ? std::abs(after - before) : 0);
    }
    result.slope = (observer.estimate()[0] - at_1_s) / 4;
    return result;
}

TEST_CASE("rounded rates change an estimate by hardly more than its step") {
    CHECK(after_rounding(0.1, unlimited).change == Approx(bandwidth * (1.5 * 0.1 + 1e-3)).epsilon(0.01));
    const Rounded coarse = after_rounding(0.1, 0.5);
    CHECK(coarse.change <= 1.1 * 0.5);
    CHECK(coarse.change > 0.5);
    // what is lost is bandwidth: feedback and rate keep their ratio
    CHECK(coarse.slope == Approx(0.5 / (1.5 * 0.1)).epsilon(0.05));
    CHECK(after_rounding(0.001, 0.5).slope == Approx(bandwidth).epsilon(0.05));
}

/// Largest change in a tick of feedback and estimate, after the first second, for a rate that is rounded to
/// multiples of `count` and damped with `damping` N·m·s/rad.
double change_by_count(double count, double damping, double step) {
    constexpr double period = 1e-3, inertia = 1.5;
    Observer observer({}, {period, {{bandwidth}}, {{1e6}}, {{step}}, {{unlimited}}});
    double largest = 0, before = 0;
    for (int tick = 0; tick < 5000; ++tick) {
        const double rate = count * std::round(0.7 * std::sin(0.03 * tick) + 0.6 * std::sin(0.41 * tick));
        const double feedback = damping * rate;
        const double after = feedback + observer.update(&feedback, &inertia, &rate, &none)[0];
        largest = std::max(largest, tick > 1000 ? std::abs(after - before) : 0);
        before = after;
    }
    return largest;
}

TEST_CASE("where the feedback is noisy the observer adds less noise of its own") {
    constexpr double step = 0.5, count = 0.1;
    const double quiet = 0.3 * step / count, noisy = 1.6 * step / count;
    CHECK(change_by_count(count, quiet, step) == Approx((1 + 0.3) * step).epsilon(0.05));
    CHECK(change_by_count(count, noisy, step) == Approx(2 * step).epsilon(0.05));
    CHECK(change_by_count(count, 3 * noisy, step) == Approx(4.8 * step + step / 4).epsilon(0.05));
}

TEST_CASE("an estimate does not jump when its bandwidth changes or it begins in motion") {
    constexpr double period = 1e-3, inertia = 1.5, step = 0.5;
    Observer observer({}, {period, {{bandwidth}}, {{1e6}}, {{step}}, {{unlimited}}});
    double rate = 3; // rad/s
    CHECK(observer.update(&none, &inertia, &rate, &none)[0] == 0);
    const auto change_to = [&](double next) {
        const double before = observer.estimate()[0];
        rate = next;
        return std::abs(observer.update(&none, &inertia, &rate, &none)[0] - before);
    };
    CHECK(change_to(3.001) == Approx(bandwidth * inertia * 0.001));
    CHECK(change_to(3.1) == Approx(step)); // the bandwidth falls to an eighth
    CHECK(change_to(3.11) < step);
}

TEST_CASE("one wrong rate or feedback lowers an observer's bandwidth for seconds only") {
    constexpr float period = 1e-3F, inertia = 1.5F, excess = 0, push = 1;
    const int before = GENERATE(0, 10); // ticks
    CAPTURE(before);
    const auto slope_after = [&](const float(&feedbacks)[2], float wrong_rate) {
        DisturbanceObserver<float, 1> observer(
            {}, {period, {{40}}, {{1100}}, {{0.5F}}, {{std::numeric_limits<float>::infinity()}}});
        constexpr float zero = 0;
        for (int tick = 0; tick < before; ++tick) {
            observer.update(&zero, &inertia, &zero, &zero);
        }
        for (const float feedback : feedbacks) {
            observer.update(&feedback, &inertia, &wrong_rate, &excess);
            wrong_rate = 0;
        }
        float at_24_s = 0;
        for (int tick = 1; tick <= 25'000; ++tick) {
            const float rate = tick % 2 == 0 ? 0.0F : 0.005F; // noise
            const float estimate = observer.update(&push, &inertia, &rate, &excess)[0];
            at_24_s = tick == 24'000 ? estimate : at_24_s;
        }
        return observer.estimate()[0] - at_24_s;
    };
    CHECK(slope_after({0, 0}, 0) == Approx(40).epsilon(0.01));
    CHECK(slope_after({0, 0}, 1e4F) >= 0.9F * 40);
    CHECK(slope_after({3e38F, -3e38F}, 0) >= 0.9F * 40);
}

/// Torques of feedback and observer on a motor whose link is held by an elastic gear.
struct ElasticRun {
    double share;  ///< left of the observer's bandwidth
    double swings; ///< height of the torque in the last second of ten, N·m
};
ElasticRun run_on_elastic_gear(double observer_bandwidth, double swing) {
    constexpr double motor = 0.6, link = 0.9, damping = 2, period = 1e-3;
    constexpr double rate = 2 * 3.14159 * 25; // of the link while the motor is held, rad/s
    constexpr double stiffness = link * rate * rate, inertia = motor + link;
    constexpr int substeps = 20, delay = 4;
    Observer observer({}, {period, {{observer_bandwidth}}, {{100}}, {{unlimited}}, {{swing}}});
    double angle = 0, speed = 0, link_angle = 0, link_speed = 0, lowest = 0, highest = 0;
    std::deque<double> torques(delay, 0.0);
    for (int tick = 0; tick < 10'000; ++tick) {
        const double feedback = -400 * angle - 60 * speed, error_rate = -speed;
        const double estimate = observer.update(&feedback, &inertia, &error_rate, &none)[0];
        torques.push_back(std::clamp(feedback + estimate, -100.0, 100.0));
        for (int step = 0; step < substeps; ++step) {
            const double spring =
                stiffness * (link_angle - angle) + damping * (link_speed - speed); // on the motor
            speed += period / substeps * (torques.front() + spring) / motor;
            link_speed += period / substeps * (10 - spring) / link; // a load of 10 N·m
            angle += period / substeps * speed;
            link_angle += period / substeps * link_speed;
        }
        lowest = tick == 9000 ? torques.back() : std::min(lowest, torques.back());
        highest = tick == 9000 ? torques.back() : std::max(highest, torques.back());
        torques.pop_front();
    }
    return {observer.share()[0], highest - lowest};
}

TEST_CASE("an observer that makes an elastic gear vibrate lowers its bandwidth until the gear is calm") {
    REQUIRE(run_on_elastic_gear(0, unlimited).swings < 0.1); // the feedback alone is stable
    REQUIRE(run_on_elastic_gear(bandwidth, unlimited).swings > 20);
    const ElasticRun watched = run_on_elastic_gear(bandwidth, 5);
    CHECK(watched.swings < 5);
    CHECK(watched.share < 1);
    CHECK(watched.share >= 0.125);
    CHECK(run_on_elastic_gear(bandwidth / 16, 5).share == 1); // nothing to lower
}

/// Feeds `ticks` torques of a joint that vibrates at 25 Hz with 40 N·m from peak to peak.
void vibrate(Observer& observer, int ticks) {
    for (int tick = 0; tick < ticks; ++tick) {
        const double feedback = 20 * std::sin(2 * std::numbers::pi * 25 * 1e-3 * tick);
        observer.update(&feedback, &none, &none, &none);
    }
}

TEST_CASE("vibrations lower a bandwidth for good, at most to its least share; none that is not watched") {
    Observer observer({}, {1e-3, {{bandwidth}}, {{1}}, {{unlimited}}, {{5}}});
    vibrate(observer, 120); // six turns
    observer.restart();
    vibrate(observer, 120);
    CHECK(observer.share()[0] == 1);
    vibrate(observer, 10'000);
    CHECK(observer.share()[0] == Observer::least_share);
    observer.restart();
    CHECK(observer.share()[0] == Observer::least_share);
    for (const double swing : {0.0, unlimited, std::numeric_limits<double>::quiet_NaN()}) {
        Observer unwatched({}, {1e-3, {{bandwidth}}, {{1}}, {{unlimited}}, {{swing}}});
        vibrate(unwatched, 10'000);
        CHECK(unwatched.share()[0] == 1);
    }
    Observer off({}, {1e-3, {{0}}, {{1}}, {{unlimited}}, {{5}}});
    vibrate(off, 10'000);
    CHECK(off.share()[0] == 1);
}

TEST_CASE("inputs that are not finite or too large do not change the estimate") {
    DisturbanceObserver<float, 2> observer({}, {0.001F, {{20, 20}}, {{5, 5}}, {{5, 5}}, {{5, 5}}});
    const float inertia[] = {1, 1};
    const float zero[] = {0, 0};
    const float push[] = {4, 4};
    observer.update(push, inertia, zero, zero);
    const float before = observer.estimate()[0];
    REQUIRE(before > 0);
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const float broken[] = {bad, 4};
        observer.update(broken, inertia, zero, zero);
        CHECK(observer.estimate()[0] == before);
        observer.update(zero, inertia, broken, zero);
        CHECK(observer.estimate()[0] == before);
        observer.update(push, inertia, zero, broken);
        CHECK(observer.estimate()[0] == before);
    }
    const float huge[] = {0.9F * std::numeric_limits<float>::max(), 0};
    observer.update(zero, inertia, huge, zero); // the product with the bandwidth is infinite
    observer.update(zero, inertia, huge, zero);
    CHECK(observer.estimate()[0] == before);
    CHECK(observer.estimate()[1] > before);
    observer.restart();
    CHECK(observer.estimate()[0] == 0);
}

} // namespace disturbance_observer_test
