// SPDX-License-Identifier: Apache-2.0
// Scans of a residual into which a known effect was planted.
#include "tools/diagnosis/candidates/weighted_residual.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double persistent = 0.98; ///< correlation from one row to the next

/// Noise of variance 1 that is as slow as the residuals of real torques.
VectorXd slow_noise(Index rows, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    VectorXd noise(rows);
    double state = normal(engine);
    for (Index row = 0; row < rows; ++row) {
        noise[row] = state;
        state = persistent * state + std::sqrt(1 - persistent * persistent) * normal(engine);
    }
    return noise;
}

/// Closed-form variance per bin of `slow_noise`.
VectorXd slow_spectrum(const SpectralRows& rows, double rate_hz) {
    VectorXd spectrum(rows.bins());
    for (Index bin = 0; bin < rows.bins(); ++bin) {
        const double angle = 2 * std::numbers::pi * rows.frequency_hz(bin) / rate_hz;
        spectrum[bin] =
            (1 - persistent * persistent) / (1 - 2 * persistent * std::cos(angle) + persistent * persistent);
    }
    return spectrum;
}

/// The UR5 with residuals of slow noise, and their weighted forms.
struct Residual {
    DiagnosisSignals signals = signals_of(ur5(), OutputKind::joint_torque);
    SpectralRows rows{signals.measured};
    MatrixXd left;

    explicit Residual(std::mt19937_64& engine) : left(signals.rows(), signals.outputs()) {
        for (Index joint = 0; joint < left.cols(); ++joint) {
            left.col(joint) = slow_noise(left.rows(), engine);
        }
    }

    EffectRegression regression() const {
        EffectRegression result(rows, left, rows.frames());
        const VectorXd spectrum = slow_spectrum(rows, signals.measured.rate_hz);
        result.set_noise(spectrum.replicate(1, left.cols()),
                         std::vector<MatrixXd>(static_cast<std::size_t>(left.cols()),
                                               MatrixXd::Ones(rows.bins(), rows.frames())));
        return result;
    }

    MatrixXd weighted() const {
        return weighted_residual_away_from_reversals(signals, regression(), VectorXd(0));
    }
};

} // namespace

TEST_CASE("slow noise alone yields no conspicuous push") {
    DFDYN_SEEDED_ENGINE(engine);
    const Residual residual(engine);
    const std::vector<ContactSite> sites = contact_sites(residual.signals);
    for (const Candidate& push :
         scan_contacts(residual.signals, residual.regression(), residual.weighted(), sites)) {
        INFO(push.where);
        // 1.5 times the fourth largest of several hundred squares of a standard normal variable.
        CHECK(push.evidence_offset < 1.5 * 16);
    }
}

TEST_CASE("a push in slow noise is found at its time and does not raise its own threshold") {
    DFDYN_SEEDED_ENGINE(engine);
    Residual residual(engine);
    const double start_s = std::uniform_real_distribution<double>(3, 15)(engine);
    residual.left.col(3) -= 8 * pulse_series(residual.signals, {start_s, start_s + 1.5, 0.4});
    const std::vector<ContactSite> sites = contact_sites(residual.signals);
    const std::vector<Candidate> pushes =
        scan_contacts(residual.signals, residual.regression(), residual.weighted(), sites);
    const auto push = std::ranges::find(pushes, "joint4", &Candidate::where);
    REQUIRE(push != pushes.end());
    const std::vector<EffectParameter> found = push->parameters(VectorXd::Ones(1), push->shapes.front());
    CHECK(std::abs(found[0].value - start_s) < 0.5);
    CHECK(std::abs(found[1].value - start_s - 1.5) < 0.5);
    CHECK(push->evidence_offset < 1.5 * 16);
}

TEST_CASE("a late payload must explain more than loads of short duration would") {
    DFDYN_SEEDED_ENGINE(engine);
    Residual residual(engine);
    const std::vector<EffectColumn> payload = payload_columns(residual.signals);
    const double taken_s = residual.signals.measured.time_s.tail(1)[0] - 1.5;
    const auto demanded = [&] {
        const EffectRegression regression = residual.regression();
        const MatrixXd weighted = weighted_residual(regression, VectorXd(0));
        return payload_evidence_threshold(residual.signals, regression, weighted, payload, taken_s);
    };
    // 1.5 times the fourth largest of a hundred sums of four squares of a standard normal variable.
    CHECK(demanded() < 1.5 * 15);

    const Candidate mass = find(static_candidates(residual.signals), "payload", "tool");
    const MatrixXd load = 2 * contribution(residual.signals, mass, 0);
    const MatrixXd precision = residual.regression().noise().cwiseInverse();
    std::vector<double> explained;
    for (const Index first : {198, 702, 1206, 1710}) { // starts of windows that the scan examines
        MatrixXd burst = MatrixXd::Zero(load.rows(), load.cols());
        burst.middleRows(first, 151) = load.middleRows(first, 151);
        residual.left += burst;
        explained.push_back(0);
        for (Index output = 0; output < load.cols(); ++output) {
            const MatrixXd squares = residual.rows.analyse(burst.col(output)).cwiseAbs2();
            explained.back() += squares.rowwise().sum().dot(precision.col(output));
        }
    }
    const double least = *std::ranges::min_element(explained);
    // The threshold exceeds the log-evidence of one load, `explained` / 2, but is less than 1.5 times as high
    // because the windows share one weight.
    CHECK(demanded() > 0.5 * least);
    CHECK(demanded() < 0.8 * least);
}

TEST_CASE("the threshold of an early payload is zero because no windows remain for comparison") {
    DFDYN_SEEDED_ENGINE(engine);
    const Residual residual(engine);
    const EffectRegression regression = residual.regression();
    CHECK(payload_evidence_threshold(residual.signals, regression, weighted_residual(regression, VectorXd(0)),
                                     payload_columns(residual.signals), 8) == 0);
}

TEST_CASE("a residual that occurs only at reversals is interpolated") {
    DFDYN_SEEDED_ENGINE(engine);
    Residual residual(engine);
    const VectorXd velocity = residual.signals.measured.motion.velocity.col(0);
    const MatrixXd bridged = residual.weighted();
    const MatrixXd all = weighted_residual(residual.regression(), VectorXd(0));
    const VectorXd bump = 5 * (std::numbers::pi * VectorXd::LinSpaced(17, -1, 1).array() / 2).cos().square();
    for (Index row = 8; row + 9 < velocity.size(); ++row) {
        if ((velocity[row] > 0) != (velocity[row - 1] > 0)) {
            residual.left.col(0).segment(row - 8, 17) += bump;
        }
    }
    const MatrixXd more = weighted_residual(residual.regression(), VectorXd(0)) - all;
    CHECK((residual.weighted() - bridged).norm() < 0.1 * more.norm());
}
