// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/lapped_transform.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

VectorXd white_noise(Index count, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    VectorXd noise(count);
    for (double& value : noise) {
        value = normal(engine);
    }
    return noise;
}

} // namespace

TEST_CASE("the lapped transform is orthonormal so that coefficients survive synthesis and analysis") {
    DFDYN_SEEDED_ENGINE(engine);
    const LappedTransform transform(32, 32);
    const Index samples = 32 * 12;
    const Index frames = transform.frames(samples);
    REQUIRE(frames == 11);
    const MatrixXd coefficients = white_noise(32 * frames, engine).reshaped(32, frames);
    const MatrixXd again = transform.analyse(transform.synthesise(coefficients, samples));
    CHECK((again - coefficients).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("the energy of a sine lies in the bins around its frequency") {
    constexpr double cycles_per_sample = 10.5 / 128; // between the bins
    const LappedTransform transform(64, 64);
    const VectorXd time = VectorXd::LinSpaced(64 * 20, 0, 64 * 20 - 1);
    const VectorXd sine = (2 * std::numbers::pi * cycles_per_sample * time.array()).sin();
    const VectorXd power = transform.analyse(sine).rowwise().squaredNorm();
    Index peak = 0;
    power.maxCoeff(&peak);
    CHECK(std::abs(peak - 10) <= 1);
    CHECK(power.tail(64 - 24).sum() < 1e-6 * power.sum());
}

TEST_CASE("the spectrum of first-order autoregressive noise equals the closed form") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double memory = 0.9;
    VectorXd noise = white_noise(40000, engine);
    for (Index i = 1; i < noise.size(); ++i) {
        noise[i] += memory * noise[i - 1];
    }
    const LappedTransform transform(200, 200);
    const MatrixXd coefficients = transform.analyse(noise);
    const VectorXd spectrum = noise_spectrum(coefficients, RowVectorXd::Ones(coefficients.cols()),
                                             VectorXd::Zero(transform.bins()));
    for (Index bin = 4; bin < 190; bin += 5) {
        const double phase = std::numbers::pi * (static_cast<double>(bin) + 0.5) / 200;
        const double expected = 1 / (1 - 2 * memory * std::cos(phase) + memory * memory);
        INFO("bin " << bin);
        // With 200 frames the standard deviation is at most 10 %.
        CHECK(spectrum[bin] == Approx(expected).epsilon(0.25));
    }
}

TEST_CASE("a burst raises the noise level of its own frames only") {
    DFDYN_SEEDED_ENGINE(engine);
    VectorXd noise = white_noise(100 * 40, engine);
    noise.segment(2000, 100) *= 8;
    const LappedTransform transform(100, 60);
    const MatrixXd coefficients = transform.analyse(noise);
    const MatrixXd noise_scale =
        local_noise_scale(coefficients, RowVectorXd::Ones(coefficients.cols()), VectorXd::Ones(60));
    CHECK(noise_scale.col(20).minCoeff() > 5);
    CHECK(noise_scale.leftCols(18).maxCoeff() < 3);
    CHECK(noise_scale.rightCols(16).maxCoeff() < 3);
}
