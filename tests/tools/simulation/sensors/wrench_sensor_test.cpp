// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/wrench_sensor.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <numbers>

namespace wrench_sensor_test {

using namespace dfdyn::tools;

constexpr double period_s = 1.25e-4;

WrenchSensorModel fine() {
    WrenchSensorModel model;
    model.range = Wrench::Constant(100);
    model.bits = 40;
    return model;
}

/// Ratio of the reading's amplitude to the wrench's, for a sine of `frequency_hz`.
double gain(const WrenchSensorModel& model, double frequency_hz) {
    WrenchSensor sensor(model, period_s, 1);
    double sine = 0;
    double cosine = 0;
    const int steps = 16000;
    for (int i = 0; i < 2 * steps; ++i) {
        const double angle = 2 * std::numbers::pi * frequency_hz * i * period_s;
        sensor.observe(i * period_s, Wrench::Constant(std::sin(angle)));
        if (i >= steps && i % 8 == 0) { // only at the times of readings
            sine += sensor.reading()[0] * std::sin(angle);
            cosine += sensor.reading()[0] * std::cos(angle);
        }
    }
    return std::hypot(sine, cosine) / (steps / 16.0);
}

TEST_CASE("the F/T sensor's -3 dB frequency is its bandwidth and its order sets the roll-off") {
    WrenchSensorModel model = fine();
    model.bandwidth_hz = 60;
    for (const int order : {1, 2}) {
        CAPTURE(order);
        model.order = order;
        CHECK(gain(model, 2) == Approx(1).epsilon(0.002));
        CHECK(gain(model, 60) == Approx(std::sqrt(0.5)).epsilon(0.002));
        const double octave = order == 1 ? 1 / std::sqrt(5.0) : 1 / std::sqrt(17.0);
        CHECK(gain(model, 120) == Approx(octave).epsilon(0.02));
    }
}

TEST_CASE("the F/T sensor lags by its delay including fractions of a step") {
    WrenchSensorModel model = fine();
    model.rate_hz = 8000;
    for (const double delay_s : {0.0, 0.0009, 0.01001}) {
        CAPTURE(delay_s);
        model.delay_s = delay_s;
        WrenchSensor sensor(model, period_s, 1);
        for (int i = 0; i <= 800; ++i) {
            sensor.observe(i * period_s, Wrench::Constant(7 * i * period_s));
        }
        CHECK(sensor.reading()[5] == Approx(7 * (0.1 - delay_s)).epsilon(1e-6));
    }
}

TEST_CASE("the F/T sensor has bias and drift and noise and 16 bits of its range and saturates") {
    WrenchSensorModel model;
    model.range << 1500, 1500, 2000, 35, 35, 25;
    WrenchSensor quantised(model, period_s, 1);
    CHECK(quantised.step()[0] == Approx(1500.0 / 32768));
    Wrench wrench;
    wrench << 3.3, -18.7, 2500, -2500, 0.001, 0;
    quantised.observe(0, wrench);
    const Wrench step = quantised.step();
    for (const Eigen::Index axis : {0, 1, 4, 5}) {
        CHECK(std::abs(quantised.reading()[axis] - wrench[axis]) <= 0.5 * step[axis] * (1 + 1e-9));
        CHECK(std::abs(std::remainder(quantised.reading()[axis], step[axis])) < 1e-9 * step[axis] + 1e-12);
    }
    CHECK(quantised.reading()[2] == 2000 - step[2]); // a 16-bit word has one more value below zero than above
    CHECK(quantised.reading()[3] == -35);

    model = fine();
    model.bias[1] = 4;
    model.drift_per_s[1] = 0.5;
    model.noise[1] = 0.3;
    WrenchSensor drifting(model, 1e-3, 1);
    double mean_early = 0;
    double mean_late = 0;
    double squares = 0;
    for (int i = 0; i < 20000; ++i) {
        drifting.observe(i * 1e-3, Wrench::Zero());
        const double error = drifting.reading()[1] - 4 - 0.5 * i * 1e-3;
        squares += error * error;
        (i < 10000 ? mean_early : mean_late) += drifting.reading()[1] / 10000;
    }
    CHECK(std::sqrt(squares / 20000) == Approx(0.3).epsilon(0.03));
    CHECK(mean_early == Approx(4 + 0.5 * 5).epsilon(0.01));
    CHECK(mean_late == Approx(4 + 0.5 * 15).epsilon(0.01));
}

TEST_CASE("a calibration error mixes the axes of the F/T sensor but not its bias") {
    WrenchSensorModel model = fine();
    model.calibration(0, 0) = 1.02;
    model.calibration(4, 2) = -0.001;
    model.bias[0] = 5;
    WrenchSensor sensor(model, period_s, 1);
    Wrench wrench;
    wrench << 10, 20, 30, 1, 2, 3;
    sensor.observe(0, wrench);
    Wrench expected;
    expected << 15.2, 20, 30, 1, 1.97, 3;
    CHECK((sensor.reading() - expected).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("the F/T sensor holds its reading until the next one") {
    WrenchSensor sensor(fine(), period_s, 1); // at 1 kHz every eighth step
    for (int i = 0; i < 32; ++i) {
        sensor.observe(i * period_s, Wrench::Constant(i));
        CHECK(sensor.reading()[0] == Approx(i - i % 8).margin(1e-6));
    }
}

} // namespace wrench_sensor_test
