// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"

#include <random>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Segments of 4.3 s and 15.7 s whose rows have random weights.
MeasuredMotion parted(std::mt19937_64& engine) {
    MeasuredMotion measured = swing(1);
    measured.stretches = {{0, 430}, {430, 1570}};
    std::uniform_real_distribution<double> share;
    measured.weight = MatrixXd::NullaryExpr(2000, 1, [&](Index, Index) { return share(engine); });
    return measured;
}

} // namespace

TEST_CASE("every row of a recording has the same weight in short and in long segments") {
    DFDYN_SEEDED_ENGINE(engine);
    MeasuredMotion measured = parted(engine);
    measured.weight.resize(0, 0);
    const SpectralRows rows(measured);
    std::uniform_int_distribution<Index> draw(40, 1950);
    for (int trial = 0; trial < 10; ++trial) {
        const Index at = draw(engine);
        INFO("row " << at);
        // A bump with frequencies well below 20 Hz.
        const VectorXd bump =
            (-0.5 * (VectorXd::LinSpaced(2000, 0, 1999).array() - static_cast<double>(at)).square() / 36)
                .exp();
        CHECK(rows.analyse(bump).squaredNorm() == Approx(bump.squaredNorm()).epsilon(0.02));
    }
}

TEST_CASE("synthesis is the transpose of analysis with weights and gaps") {
    DFDYN_SEEDED_ENGINE(engine);
    const SpectralRows rows(parted(engine));
    std::normal_distribution<double> normal;
    const VectorXd series = VectorXd::NullaryExpr(2000, [&](Index) { return normal(engine); });
    const MatrixXd coefficients =
        MatrixXd::NullaryExpr(rows.bins(), rows.frames(), [&](Index, Index) { return normal(engine); });
    CHECK(rows.analyse(series, 0).cwiseProduct(coefficients).sum() ==
          Approx(series.dot(rows.synthesise(coefficients, 0))));
}

TEST_CASE("rows without weight do not reduce the noise estimate") {
    DFDYN_SEEDED_ENGINE(engine);
    MeasuredMotion measured = swing(1);
    measured.weight = MatrixXd::Ones(2000, 1);
    measured.weight.col(0).segment(300, 600).setZero();
    measured.weight.col(0).segment(1200, 300).setConstant(0.5);
    const SpectralRows rows(measured);
    CHECK(rows.filled(0).sum() * SpectralRows::hop_s == Approx(20 - 6 - 0.75 * 3));
    std::normal_distribution<double> normal;
    VectorXd spectrum = VectorXd::Zero(rows.bins());
    MatrixXd noise_scale;
    for (int trial = 0; trial < 20; ++trial) {
        const VectorXd noise = VectorXd::NullaryExpr(2000, [&](Index) { return 0.3 * normal(engine); });
        spectrum += noise_spectrum(rows.analyse(noise, 0), rows.filled(0), VectorXd::Zero(rows.bins())) / 20;
        noise_scale =
            local_noise_scale(rows.analyse(noise, 0), rows.filled(0), VectorXd::Constant(rows.bins(), 0.09));
        CHECK(noise_scale.minCoeff() > 0.5);
    }
    CHECK(spectrum.tail(rows.bins() - 4).mean() ==
          Approx(0.09).epsilon(0.05)); // the slowest bins are treated as persistent noise
}

TEST_CASE("frames within a share of the recording do not depend on later rows") {
    DFDYN_SEEDED_ENGINE(engine);
    const SpectralRows rows(parted(engine));
    VectorXd late = VectorXd::Zero(2000);
    for (const double share : {0.1, 0.25, 0.5, 0.67, 0.9}) {
        late.setZero();
        const auto first = static_cast<Index>(share * 2000);
        late.tail(2000 - first - 1).setOnes();
        const Index within = rows.frames_within(share);
        INFO("share " << share << ", frames " << within << " of " << rows.frames());
        if (within > 1) {
            CHECK(rows.analyse(late).leftCols(within).isZero(0));
        }
    }
    CHECK(rows.frames_within(1) == rows.frames());
}
