// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/raw_samples.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <random>

namespace raw_samples_test {

using namespace dfdyn::tools;
using Eigen::Index;

/// 1 kHz, 8 s with a gap of 2 s in the middle, one joint; the output is noise.
Recording fast_recording(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    Recording recording;
    recording.position.names = {"q1"};
    recording.output.names = {"tau1"};
    for (int row = 0; row < 8000; ++row) {
        const double time_s = 1e-3 * row + (row < 4000 ? 0 : 2);
        recording.time_s.push_back(time_s);
        recording.time_ns.push_back(std::llround(1e9 * time_s));
        recording.gap_before.push_back(row == 0 || row == 4000 ? 1 : 0);
        recording.position.values.push_back(std::sin(2 * time_s));
        recording.output.values.push_back(normal(engine));
    }
    return recording;
}

TEST_CASE("samples of a fast recording are those measured, not those of the filtered rows") {
    DFDYN_SEEDED_ENGINE(engine);
    const Recording recording = fast_recording(engine);
    const MeasuredMotion measured = measured_motion(recording);
    const RawSamples samples = raw_samples(recording, measured);
    REQUIRE(measured.time_s.size() < 1100);
    CHECK(samples.outputs.rows() > 7950); // all but those after the last row of a segment
    const double rms = std::sqrt(samples.outputs.squaredNorm() / static_cast<double>(samples.outputs.rows()));
    CHECK(rms == Approx(1).epsilon(0.05));
    const double filtered =
        std::sqrt(measured.outputs.squaredNorm() / static_cast<double>(measured.outputs.rows()));
    CHECK(filtered < 0.5);
}

TEST_CASE("a cubic of time between the rows is interpolated exactly, up to each gap") {
    DFDYN_SEEDED_ENGINE(engine);
    const Recording recording = fast_recording(engine);
    const MeasuredMotion measured = measured_motion(recording);
    const RawSamples samples = raw_samples(recording, measured);
    const auto cubic = [](const auto& t) { return (t * t * t - 4 * t * t + t - 3).eval(); };
    const Eigen::VectorXd at = samples.at(cubic(measured.time_s.array()).matrix());
    const Eigen::VectorXd time_s = samples.at(measured.time_s);
    CHECK((at.array() - cubic(time_s.array())).abs().maxCoeff() < 1e-8);
    const Index half = measured.stretches[1].first;
    CHECK(time_s[samples.before(half)] == Approx(6).margin(1e-3));
    CHECK(own_samples(measured, measured.outputs).at(measured.outputs) == measured.outputs);
}

} // namespace raw_samples_test
