// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/encoders.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tools/simulation/sensors/derivative_estimator.hpp"

#include <cmath>
#include <numbers>

namespace encoders_test {

using namespace dfdyn::tools;
using dfdyn::tests::uniform;

EncoderModel perfect(int joints) {
    EncoderModel model;
    model.eccentricity = JointVector::Zero(joints);
    model.eccentricity_phase = JointVector::Zero(joints);
    return model;
}

TEST_CASE("the error of a 12-bit encoder is uniform within one count of 2 pi / 4096") {
    EncoderModel model = perfect(1);
    model.bits_per_turn = 12;
    Encoders encoders(model, {false}, 1);
    const double count = 2 * std::numbers::pi / 4096;
    CHECK(encoders.count(0) == Approx(count));
    DFDYN_SEEDED_ENGINE(engine);
    constexpr int samples = 20000;
    double sum = 0;
    double squares = 0;
    int tenths[10] = {};
    for (int i = 0; i < samples; ++i) {
        const JointVector q = JointVector::Constant(1, uniform(engine, -3, 3));
        encoders.observe(q);
        CHECK(std::abs(std::remainder(encoders.reading()[0], count)) < 1e-12);
        const double error = (encoders.reading()[0] - q[0]) / count;
        REQUIRE(std::abs(error) <= 0.5 + 1e-9);
        sum += error;
        squares += error * error;
        ++tenths[std::min(9, static_cast<int>((error + 0.5) * 10))];
    }
    CHECK(std::abs(sum / samples) < 0.01);
    CHECK(squares / samples == Approx(1.0 / 12).epsilon(0.03));
    double chi_squared = 0;
    for (const int hits : tenths) {
        chi_squared += std::pow(hits - samples / 10, 2) / (samples / 10.0);
    }
    CHECK(chi_squared < 33); // 9 degrees of freedom; exceeded with a probability of 1e-4
}

TEST_CASE("eccentricity has one cycle per turn and noise its size and prismatic joints count per metre") {
    EncoderModel model = perfect(2);
    model.eccentricity << 0.01, 0;
    model.eccentricity_phase << 0.3, 0;
    Encoders eccentric(model, {false, true}, 1);
    eccentric.observe(JointVector::Constant(2, 0.9));
    CHECK(eccentric.reading()[0] == Approx(0.9 + 0.01 * std::sin(1.2)));
    CHECK(eccentric.reading()[1] == 0.9);

    model = perfect(2);
    model.noise = 0.02;
    Encoders noisy(model, {false, true}, 1);
    double squares = 0;
    for (int i = 0; i < 5000; ++i) {
        noisy.observe(JointVector::Zero(2));
        squares += noisy.reading().squaredNorm();
    }
    CHECK(std::sqrt(squares / 10000) == Approx(0.02).epsilon(0.03));

    model.bits_per_turn = 10;
    CHECK(Encoders(model, {false, true}, 1).count(1) == 1.0 / 1024);
}

TEST_CASE("velocity and acceleration of a parabola are exact and 0 until there are enough readings") {
    DerivativeModel model;
    model.noise_bound = 1e-9;
    DerivativeEstimator estimator(model, 1, 1e-3);
    estimator.observe(JointVector::Constant(1, 0.5));
    CHECK(estimator.velocity()[0] == 0);
    for (int i = 1; i <= 40; ++i) {
        const double t = 1e-3 * i;
        estimator.observe(JointVector::Constant(1, 0.5 + 2 * t));
    }
    CHECK(estimator.velocity()[0] == Approx(2));
    DerivativeEstimator curved(model, 1, 1e-3);
    for (int i = 0; i <= 40; ++i) {
        const double t = 1e-3 * i;
        curved.observe(JointVector::Constant(1, 1 - t + 4 * t * t));
    }
    CHECK(curved.acceleration()[0] == Approx(8).epsilon(1e-6));
}

} // namespace encoders_test
