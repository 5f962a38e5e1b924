// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/adaptive_window.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace adaptive_window_test {

using dfdyn::AdaptiveWindow;
using Signal = std::function<double(double)>;

constexpr double period = 1e-3;

/// Returns samples of a signal, newest first, at given ages (times ≤ 0 relative to `now`).
template <class Scalar>
struct Samples {
    std::vector<Scalar> ages;
    std::vector<Scalar> values;

    Samples(const Signal& signal, double now, const std::vector<double>& times) {
        for (const double age : times) {
            ages.push_back(static_cast<Scalar>(age));
            values.push_back(static_cast<Scalar>(signal(now + age)));
        }
    }

    [[nodiscard]] AdaptiveWindow<Scalar> window(double noise_bound) const {
        return {ages.data(), values.data(), 1, static_cast<int>(ages.size()),
                static_cast<Scalar>(noise_bound)};
    }
};

std::vector<double> uniform_ages(int count) {
    std::vector<double> ages;
    for (int i = 0; i < count; ++i) {
        ages.push_back(-period * i);
    }
    return ages;
}

std::vector<double> uneven_ages(std::mt19937_64& engine, int count) {
    std::uniform_real_distribution<double> step(0.3 * period, 2 * period);
    std::vector<double> ages{0};
    while (static_cast<int>(ages.size()) < count) {
        ages.push_back(ages.back() - step(engine));
    }
    return ages;
}

/// Returns the largest error of the velocity at 1,000 times.
double largest_velocity_error(const Signal& signal, const Signal& derivative, int count, double noise_bound) {
    double largest = 0;
    for (int t = 0; t < 1000; ++t) {
        const double now = 0.00137 * t;
        const Samples<double> samples(signal, now, uniform_ages(count));
        largest = std::max(largest, std::abs(samples.window(noise_bound).velocity() - derivative(now)));
    }
    return largest;
}

double quantised(double value, double count) { return std::floor(value / count) * count; }

TEMPLATE_TEST_CASE("a straight line and a parabola are fitted exactly at uneven times", "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const double tolerance = std::is_same_v<TestType, float> ? 1e-3 : 1e-9;
    for (int trial = 0; trial < 50; ++trial) {
        std::normal_distribution<double> normal;
        const double slope = normal(engine);
        const double curvature = 100 * normal(engine);
        const auto ages = uneven_ages(engine, 3 + trial);
        const Samples<TestType> line([&](double t) { return 0.1 + slope * t; }, 0, ages);
        CHECK(static_cast<double>(line.window(1e-5).velocity()) == Approx(slope).margin(tolerance));
        const Samples<TestType> parabola([&](double t) { return slope * t + curvature / 2 * t * t; }, 0,
                                         ages);
        CHECK(static_cast<double>(parabola.window(1e-5).acceleration()) ==
              Approx(curvature).margin(tolerance * 100).epsilon(tolerance));
    }
}

// A line fitted to a parabola with acceleration a has the error a h²/3 at the ends of a window of length 2h,
// and its slope has the error a h at the newest sample. With the longest window that the noise bound δ allows
// this is sqrt(3 δ a).
TEST_CASE("the error on a smooth motion is within the bound that follows from the noise bound") {
    constexpr double omega = 4;
    const Signal sine = [](double t) { return std::sin(omega * t); };
    const Signal cosine = [](double t) { return omega * std::cos(omega * t); };
    constexpr double largest_acceleration = omega * omega;
    for (const double bound : {1e-6, 1e-5, 1e-4}) {
        CAPTURE(bound);
        const double promised = std::sqrt(3 * bound * largest_acceleration) + largest_acceleration * period;
        CHECK(largest_velocity_error(sine, cosine, 60, bound) < promised);
        CHECK(largest_velocity_error(sine, cosine, 60, bound) > promised / 10);
    }
}

// The slope of a line through L values, each with an error of at most half a count, has an error of at most
// 1.5 counts / L per sample. The difference of two values has an error of up to one count per sample.
TEST_CASE("on a quantised ramp the window grows and the ripple is much smaller than one count per sample") {
    constexpr double count = 1e-4;
    constexpr int length = 50;
    for (const double counts_per_sample : {0.03, 0.3, 0.77, 3.2}) {
        CAPTURE(counts_per_sample);
        const double speed = counts_per_sample * count / period;
        const Signal ramp = [&](double t) { return quantised(speed * t, count); };
        const Signal truth = [&](double) { return speed; };
        CHECK(largest_velocity_error(ramp, truth, length, count) <= 1.5 / length * count / period);
        CHECK(largest_velocity_error(ramp, truth, 2, count) > 0.2 * count / period);
    }
}

TEST_CASE("after a sudden change the window shrinks to the samples since then") {
    const Signal corner = [](double t) { return t < 0 ? 0 : 5 * t; };
    for (int samples_after = 1; samples_after < 10; ++samples_after) {
        const Samples<double> samples(corner, samples_after * period, uniform_ages(50));
        CHECK(samples.window(1e-4).velocity() == Approx(5).epsilon(1e-9));
    }
    const Samples<double> long_before(corner, -period, uniform_ages(50));
    CHECK(long_before.window(1e-4).velocity() == 0);
}

TEST_CASE("the acceleration of a quantised parabola has an error of a few percent") {
    constexpr double count = 1e-5;
    const Signal parabola = [](double t) { return quantised(5 * t * t, count); };
    for (int t = 0; t < 100; ++t) {
        const Samples<double> samples(parabola, 0.3 + 0.00137 * t, uniform_ages(60));
        CHECK(samples.window(count).acceleration() == Approx(10).epsilon(0.05));
    }
}

// Two positions give a velocity for any bound: rounding must not turn a fast joint into a stationary one.
TEMPLATE_TEST_CASE("with a noise bound below rounding the velocity is the difference of the newest samples",
                   "", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    for (int trial = 0; trial < 200; ++trial) {
        std::uniform_real_distribution<double> position(-3, 3);
        const Samples<TestType> noise([&](double) { return position(engine); }, 0, uneven_ages(engine, 10));
        const auto& t = noise.ages;
        const auto& q = noise.values;
        const double velocity = static_cast<double>((q[0] - q[1]) / (t[0] - t[1]));
        CHECK(static_cast<double>(noise.window(0).velocity()) == Approx(velocity).epsilon(1e-4));
        const double earlier = static_cast<double>((q[1] - q[2]) / (t[1] - t[2]));
        const double half_time = static_cast<double>(t[0] - t[2]) / 2;
        CHECK(static_cast<double>(noise.window(0).acceleration()) ==
              Approx((velocity - earlier) / half_time)
                  .margin(1e-4 * (std::abs(velocity) + std::abs(earlier)) / half_time));
    }
}

TEST_CASE("too few samples give a derivative of zero") {
    const Signal ramp = [](double t) { return 5 * t; };
    CHECK(Samples<double>(ramp, 0, uniform_ages(1)).window(1).velocity() == 0);
    CHECK(Samples<double>(ramp, 0, uniform_ages(2)).window(1).velocity() == Approx(5));
    CHECK(Samples<double>(ramp, 0, uniform_ages(2)).window(1).acceleration() == 0);
}

TEST_CASE("the values may have a stride") {
    const double ages[] = {0, -1, -2};
    const double values[] = {7, 99, 5, 99, 3, 99};
    CHECK(AdaptiveWindow<double>(ages, values, 2, 3, 1e-9).velocity() == Approx(2));
}

TEST_CASE("the slope of a reference over the window of the measurements has the same delay") {
    const Signal reference = [](double t) { return std::sin(3 * t); };
    const Signal position = [&](double t) { return reference(t) - 0.02 * t; };
    constexpr double noise_bound = 1e-4;
    double largest_error = 0;
    double largest_delay = 0;
    for (int t = 0; t < 1000; ++t) {
        const double now = 0.00137 * t;
        const Samples<double> readings(position, now, uniform_ages(20));
        const Samples<double> references(reference, now, uniform_ages(20));
        const AdaptiveWindow<double> window = readings.window(noise_bound);
        const double rate = window.slope_of(references.values.data()) - window.velocity();
        largest_error = std::max(largest_error, std::abs(rate - 0.02));
        largest_delay = std::max(largest_delay, std::abs(3 * std::cos(3 * now) - 0.02 - window.velocity()));
    }
    CHECK(largest_error < 1e-9);
    CHECK(largest_delay > 0.05); // the delay relative to the present velocity of the reference
    constexpr double alone = 0;
    CHECK(AdaptiveWindow<double>(&alone, &alone, 1, 1, noise_bound).slope_of(&alone) == 0);
}

} // namespace adaptive_window_test
