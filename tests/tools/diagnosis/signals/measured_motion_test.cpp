// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/measured_motion.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/text/error.hpp"
#include "tools/diagnosis/signals/low_pass_kernel.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double swing_hz = 0.7;

/// A swinging joint, measured by an encoder of 2^16 counts per turn with a jittering clock.
Recording swinging(double rate_hz, double duration_s, std::mt19937_64& engine, double jitter_s) {
    constexpr double count = 2 * std::numbers::pi / 65536;
    std::normal_distribution<double> normal;
    Recording recording;
    recording.source = "swing.csv";
    recording.position.names = {"q1"};
    recording.output.names = {"tau1"};
    const auto rows = static_cast<int>(rate_hz * duration_s);
    for (int row = 0; row < rows; ++row) {
        const double time_s = row / rate_hz + jitter_s * std::min(2.0, std::max(-2.0, normal(engine)));
        const double position = std::sin(2 * std::numbers::pi * swing_hz * time_s);
        recording.time_s.push_back(time_s);
        recording.time_ns.push_back(std::llround(1e9 * time_s));
        recording.position.values.push_back(count * std::floor(position / count));
        recording.output.values.push_back(std::cos(2 * std::numbers::pi * swing_hz * time_s));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
    }
    return recording;
}

/// Replaces the positions by those of another joint (`position`, rad, at a time in s) and encoder.
template <class Position>
void measure(Recording& recording, int counts_per_turn, Position position) {
    const double count = 2 * std::numbers::pi / counts_per_turn;
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        recording.position.values[row] = count * std::round(position(recording.time_s[row]) / count);
    }
}

double middle_rms(const VectorXd& series) {
    const Index third = series.size() / 3;
    return std::sqrt(series.segment(third, third).squaredNorm() / static_cast<double>(third));
}

} // namespace

TEST_CASE("velocity and acceleration of a quantised swing with jitter are close to those of the swing") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double rate_hz : {100.0, 125.0, 500.0}) {
        const MeasuredMotion measured = measured_motion(swinging(rate_hz, 20, engine, 0.1 / rate_hz));
        INFO("rate " << rate_hz << " Hz");
        CHECK(measured.rate_hz >= 60);
        CHECK(measured.rate_hz <= 130);
        const double omega = 2 * std::numbers::pi * swing_hz;
        const Eigen::ArrayXd angle = omega * measured.time_s.array();
        CHECK(middle_rms(measured.motion.velocity.col(0).array() - omega * angle.cos()) < 2e-3 * omega);
        CHECK(middle_rms(measured.motion.acceleration.col(0).array() + omega * omega * angle.sin()) <
              1e-2 * omega * omega);
        CHECK(middle_rms(measured.outputs.col(0).array() - angle.cos()) < 2e-3);
    }
}

TEST_CASE("the rounding of a slow joint by a coarse encoder does not become an acceleration") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const double swing_rad : {0.01, 0.03, 0.1}) { // 6 to 60 counts
        CAPTURE(swing_rad);
        Recording recording = swinging(125, 90, engine, 0);
        measure(recording, 4096, [swing_rad](double time_s) { // 0.05 and 0.13 Hz
            return swing_rad * (std::sin(0.314 * time_s) + 0.3 * std::sin(0.817 * time_s + 1));
        });
        // the largest true acceleration is 0.3 swing_rad, at most 0.03 rad/s²
        CHECK(middle_rms(measured_motion(recording).motion.acceleration.col(0)) < 0.1);
    }
}

TEST_CASE("a fine encoder keeps the fast motion of a joint that also moves slowly") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording recording = swinging(500, 40, engine, 0);
    measure(recording, 1 << 19, [](double time_s) {
        constexpr double fast_hz = 8;
        return std::sin(2 * std::numbers::pi * swing_hz * time_s) +
               0.01 * std::sin(2 * std::numbers::pi * fast_hz * time_s);
    });
    CHECK(measured_motion(recording).smoothing_hz[0] > 10);
}

TEST_CASE("a gap splits a recording and parts that are too short are dropped or an error if none is left") {
    DFDYN_SEEDED_ENGINE(engine);
    Recording recording = swinging(100, 20, engine, 0);
    recording.gap_before[1200] = 1;
    recording.gap_before[1300] = 1;
    const MeasuredMotion measured = measured_motion(recording);
    REQUIRE(measured.stretches.size() == 2);
    CHECK(measured.stretches[0].count == 1200);
    CHECK(measured.stretches[1].count == 700);
    CHECK(measured.time_s[1200] == Approx(13.0));
    CHECK_THROWS_AS(measured_motion(swinging(100, 1.5, engine, 0)), InputError);
}

TEST_CASE("the low pass keeps frequencies below its cutoff and removes those above") {
    const VectorXd kernel = low_pass_kernel(0.1);
    const auto gain = [&](double cycles_per_sample) {
        std::complex<double> sum = 0;
        for (Index i = 0; i < kernel.size(); ++i) {
            sum += kernel[i] *
                   std::polar(1.0, 2 * std::numbers::pi * cycles_per_sample * static_cast<double>(i));
        }
        return std::abs(sum);
    };
    CHECK(gain(0) == Approx(1));
    CHECK(gain(0.03) == Approx(1).margin(2e-3));
    CHECK(gain(0.1) == Approx(0.5).margin(0.01));
    CHECK(gain(0.2) < 1e-3);
}

TEST_CASE("the differences of a cubic polynomial are its derivative") {
    const VectorXd time = VectorXd::LinSpaced(20, 0, 19);
    const VectorXd cubic = time.array().cube() - 2 * time.array();
    const VectorXd slope = differentiated(cubic);
    for (Index i = 2; i < 18; ++i) {
        CHECK(slope[i] == Approx(3 * time[i] * time[i] - 2));
    }
}
