// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/zero_phase_derivatives.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <functional>
#include <random>

namespace tools = dfdyn::tools;

namespace {

/// A signal sampled at times with jitter around a period of 10 ms.
tools::Recording recording_of(const std::function<double(double)>& signal, int rows) {
    std::mt19937_64 engine(dfdyn::tests::seed());
    std::uniform_real_distribution<double> jitter(-0.003, 0.003);
    tools::Recording recording;
    recording.position.names = {"q1"};
    for (int row = 0; row < rows; ++row) {
        const double t = 5 + 0.01 * row + jitter(engine);
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::llround(1e9 * t));
        recording.position.values.push_back(signal(t));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
    }
    return recording;
}

} // namespace

TEST_CASE("zero-phase derivatives of a cubic polynomial are exact for any times") {
    const auto cubic = [](double t) { return 2 - t + 0.5 * t * t - 0.25 * t * t * t; };
    const tools::Recording recording = recording_of(cubic, 60);
    const tools::SampledDerivatives derivatives =
        tools::zero_phase_derivatives(recording, recording.position, {7, 3});
    for (std::size_t row = 0; row < 60; ++row) {
        const bool inside = row >= 7 && row + 7 < 60;
        CHECK((derivatives.valid[row] != 0) == inside);
        if (inside) {
            const double t = recording.time_s[row];
            const auto at = static_cast<Eigen::Index>(row);
            CHECK(derivatives.first(at, 0) == Approx(-1 + t - 0.75 * t * t).epsilon(1e-9));
            CHECK(derivatives.second(at, 0) == Approx(1 - 1.5 * t).epsilon(1e-7));
        }
    }
}

TEST_CASE("zero-phase derivatives of a sine have no lag") {
    const tools::Recording recording = recording_of([](double t) { return std::sin(3 * t); }, 400);
    const tools::SampledDerivatives derivatives =
        tools::zero_phase_derivatives(recording, recording.position, {});
    double in_phase = 0;
    double quadrature = 0;
    for (std::size_t row = 50; row < 350; ++row) {
        const double t = recording.time_s[row];
        in_phase += derivatives.first(static_cast<Eigen::Index>(row), 0) * std::cos(3 * t);
        quadrature += derivatives.first(static_cast<Eigen::Index>(row), 0) * std::sin(3 * t);
    }
    double cross = 0;
    double power = 0;
    for (std::size_t row = 50; row < 350; ++row) {
        cross += std::cos(3 * recording.time_s[row]) * std::sin(3 * recording.time_s[row]);
        power += std::pow(std::cos(3 * recording.time_s[row]), 2);
    }
    CHECK(in_phase / power == Approx(3).epsilon(1e-2));
    CHECK(quadrature == Approx(in_phase / power * cross).margin(1e-2 * power));
}

TEST_CASE("no derivative is computed across a gap") {
    tools::Recording recording = recording_of([](double t) { return t; }, 60);
    recording.gap_before[30] = 1;
    std::vector<std::uint8_t> valid =
        tools::zero_phase_derivatives(recording, recording.position, {5, 2}).valid;
    for (std::size_t row = 0; row < 60; ++row) {
        CHECK((valid[row] != 0) == ((row >= 5 && row < 25) || (row >= 35 && row < 55)));
    }
    recording.gap_before[30] = 0;
    for (std::size_t row = 30; row < 60; ++row) { // a gap of 40 ms
        recording.time_s[row] += 0.03;
        recording.time_ns[row] += 30'000'000;
    }
    CHECK(tools::zero_phase_derivatives(recording, recording.position, {5, 2}).valid == valid);
    CHECK(tools::zero_phase_derivatives(recording, recording.position, {40, 2}).valid ==
          std::vector<std::uint8_t>(60, 0));
}
