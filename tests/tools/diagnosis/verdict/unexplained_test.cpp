// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/unexplained.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <utility>

namespace unexplained_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Two joints that swing for 80 s at 100 Hz. Output 2 has weight in every second block of 10 s only.
DiagnosisSignals with_standstills() {
    constexpr Index rows = 8000;
    constexpr Index block = 1000;
    DiagnosisSignals signals;
    MeasuredMotion& measured = signals.measured;
    measured.rate_hz = 100;
    measured.time_s = VectorXd::LinSpaced(rows, 0, (rows - 1) / 100.0);
    measured.stretches = {{0, rows}};
    measured.outputs = MatrixXd::Zero(rows, 2);
    measured.weight = MatrixXd::Ones(rows, 2);
    measured.motion = {MatrixXd(rows, 2), MatrixXd(rows, 2), MatrixXd(rows, 2)};
    for (Index joint = 0; joint < 2; ++joint) {
        const double omega = 2 * std::numbers::pi * (joint == 0 ? 0.5 : 0.31);
        const Eigen::ArrayXd phase = omega * measured.time_s.array();
        measured.motion.position.col(joint) = 0.8 * phase.sin();
        measured.motion.velocity.col(joint) = 0.8 * omega * phase.cos();
        measured.motion.acceleration.col(joint) = -0.8 * omega * omega * phase.sin();
    }
    for (Index row = 0; row < rows; ++row) {
        measured.weight(row, 1) = row / block % 2 == 0 ? 1 : 0;
    }
    return signals;
}

TEST_CASE("a dependence of a joint that stands in half of the blocks is reported with its input") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double deviation = 0.1;
    std::normal_distribution<double> noise(0, deviation);
    const DiagnosisSignals signals = with_standstills();
    const SpectralRows rows(signals.measured);
    MatrixXd rest = MatrixXd::NullaryExpr(rows.rows(), 2, [&](Index, Index) { return noise(engine); });
    rest.col(1) += signals.measured.motion.position.col(0).array().sin().matrix();
    const std::vector<Unexplained> found =
        unexplained_rest(signals, rest, rest, MatrixXd::Constant(rows.bins(), 2, deviation * deviation));
    const auto second = std::ranges::find(found, Index{1}, &Unexplained::output);
    REQUIRE(second != found.end());
    CHECK(std::ranges::count(second->depends_on, "q1") == 1);
}

TEST_CASE("the unexplained residual is that of plain least squares where this is the extended model") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double deviation = 0.1;
    std::normal_distribution<double> noise(0, deviation);
    DiagnosisSignals signals = with_standstills();
    signals.measured.weight.setOnes();
    const SpectralRows rows(signals.measured);
    const MatrixXd white = MatrixXd::NullaryExpr(rows.rows(), 2, [&](Index, Index) { return noise(engine); });
    const MatrixXd predictable =
        signals.measured.motion.position.col(0).array().sin().matrix().replicate(1, 2);
    DiagnosisWork work;
    work.measured = white + predictable;
    work.fitted_effects.noise = MatrixXd::Constant(rows.bins(), 2, deviation * deviation);
    work.signals = std::make_shared<const DiagnosisSignals>(std::move(signals));
    work.diagnosis.by_least_squares = {false, true};
    work.rest = white;
    work.extended = MatrixXd::Zero(rows.rows(), 2); // least squares explains nothing
    set_unexplained(work);
    REQUIRE(work.diagnosis.unexplained.size() == 1);
    CHECK(work.diagnosis.unexplained.front().output == 1);
    CHECK(std::ranges::count(work.diagnosis.unexplained.front().depends_on, "q1") == 1);
}

} // namespace unexplained_test
