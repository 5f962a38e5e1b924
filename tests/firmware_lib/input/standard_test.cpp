// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/input/standard.hpp"

#include "tests/firmware_lib/support/positions.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace standard_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int joints = 2;
constexpr int lags = 20;

using Input = Standard<lags>;

template <class Scalar>
using Constants = typename Input::Constants<Scalar, joints>;
template <class Scalar>
using Map = typename Input::Map<Scalar, joints>;

template <class Scalar>
Constants<Scalar> constants() {
    return {Scalar(1e-5), {{1, 2, 4, 8, 16, 32}}};
}

/// Two joints with constant accelerations.
template <class Scalar>
Sample<Scalar, joints, 1> parabolas_at(std::int64_t time_ns) {
    const double t = 1e-9 * static_cast<double>(time_ns);
    return {time_ns,
            {{static_cast<Scalar>(0.1 + t - 20 * t * t), static_cast<Scalar>(-0.2 + 30 * t * t)}},
            {{0}},
            false};
}

TEMPLATE_TEST_CASE("STD gives position, velocity and acceleration of each joint, scaled, at uneven times", "",
                   float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto model = constants<TestType>();
    Map<TestType> map(model, {}, {}, {});
    std::int64_t time_ns = 0;
    for (int t = 0; t < 50; ++t) {
        time_ns += std::uniform_int_distribution<std::int64_t>(period_ns / 2, 3 * period_ns / 2)(engine);
        map.push(parabolas_at<TestType>(time_ns));
    }
    TestType xi[6];
    map.evaluate(xi);
    const double seconds = 1e-9 * static_cast<double>(time_ns);
    const auto sample = parabolas_at<TestType>(time_ns);
    CHECK(xi[0] == sample.position[0]);
    CHECK(static_cast<double>(xi[1]) ==
          Approx(2 * (1 - 40 * seconds)).margin(0.2)); // a line fitted to a parabola
    CHECK(static_cast<double>(xi[2]) == Approx(4 * -40).epsilon(0.01));
    CHECK(xi[3] == 8 * sample.position[1]);
    CHECK(static_cast<double>(xi[4]) == Approx(16 * 60 * seconds).margin(2));
    CHECK(static_cast<double>(xi[5]) == Approx(32 * 60).epsilon(0.01));
}

TEST_CASE("STD equals the adaptive window of each joint") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto model = constants<double>();
    Map<double> map(model, {}, {}, {});
    const Positions positions = random_positions(engine, 60, joints);
    const auto xi = inputs_after<Map<double>, double, joints>(map, positions, 6);
    std::vector<double> ages;
    std::vector<double> values;
    for (int lag = 0; lag <= lags; ++lag) {
        ages.push_back(-period_s * lag);
        values.push_back(positions[59 - static_cast<std::size_t>(lag)][1]);
    }
    const AdaptiveWindow<double> window(ages.data(), values.data(), 1, lags + 1, 1e-5);
    CHECK(xi[4] == Approx(16 * window.velocity()).epsilon(1e-9));
    CHECK(xi[5] == Approx(32 * window.acceleration()).epsilon(1e-9));
}

TEST_CASE("STD is ready after M+1 samples, and a restart discards positions and times") {
    const auto model = constants<double>();
    Map<double> map(model, {}, {}, {});
    CHECK(ready_after<double, joints>(map, lags + 1));
    map.restart();
    for (int t = 0; t <= lags; ++t) {
        map.push(
            // A jump of all positions: old positions must not appear.
            parabolas_at<double>(1'000'000'000'000 + t * period_ns));
    }
    REQUIRE(map.ready());
    Map<double> fresh(model, {}, {}, {});
    for (int t = 0; t <= lags; ++t) {
        fresh.push(parabolas_at<double>(1'000'000'000'000 + t * period_ns));
    }
    double xi[6];
    double expected[6];
    map.evaluate(xi);
    fresh.evaluate(expected);
    CHECK(std::equal(std::begin(xi), std::end(xi), std::begin(expected)));
}

TEST_CASE("STD with measured derivatives returns them scaled") {
    const StandardMeasured::Constants<double, joints> model{{{1, 2, 4, 8, 16, 32}}};
    StandardMeasured::Map<double, joints> map(model, {}, {}, {});
    CHECK_FALSE(map.ready());
    SampleWithDerivatives<double, joints, 1> sample{};
    sample.position = {{1, 2}};
    sample.velocity = {{3, 4}};
    sample.acceleration = {{5, 6}};
    map.push(sample);
    REQUIRE(map.ready());
    double xi[6];
    map.evaluate(xi);
    const double expected[] = {1, 6, 20, 16, 64, 192};
    CHECK(std::equal(std::begin(xi), std::end(xi), std::begin(expected)));
    map.restart();
    CHECK_FALSE(map.ready());
}

} // namespace standard_test
