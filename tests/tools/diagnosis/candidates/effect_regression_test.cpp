// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/swinging_arm.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <random>

namespace {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd white_noise(Index rows, Index columns, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

/// Columns as slow as functions of an arm's positions.
MatrixXd slow_columns(const MeasuredMotion& measured, Index count) {
    MatrixXd columns(measured.time_s.size(), count);
    for (Index i = 0; i < count; ++i) {
        columns.col(i) = (0.2 * static_cast<double>(i + 1) * measured.time_s.array()).cos();
    }
    return columns;
}

void set_columns(EffectRegression& regression, const MatrixXd& columns) {
    std::vector<SpectralColumnPointer> pointers;
    for (Index i = 0; i < columns.cols(); ++i) {
        const EffectColumn column{{{0, columns.col(i)}}};
        pointers.push_back(std::make_shared<const SpectralColumn>(regression.rows(), column));
    }
    regression.set_columns(std::move(pointers));
}

} // namespace

TEST_CASE("the degrees of freedom of a fit per bin are the diagonal of its hat matrix") {
    const MeasuredMotion measured = swing(1);
    const SpectralRows rows(measured);
    const MatrixXd columns = slow_columns(measured, 6);
    EffectRegression regression(rows, MatrixXd::Ones(measured.time_s.size(), 1), rows.frames());
    set_columns(regression, columns);
    const std::vector<Index> fitted{0, 1, 2, 3, 4, 5};
    const MatrixXd covariance = inverse_matrix(regression.weighted_sums().gram);

    MatrixXd spectral(rows.count(), 6);
    for (Index i = 0; i < 6; ++i) {
        spectral.col(i) = rows.analyse(columns.col(i)).reshaped();
    }
    const MatrixXd basis = orthogonal_factors(spectral).q;
    const VectorXd expected =
        basis.rowwise().squaredNorm().reshaped(rows.bins(), rows.frames()).rowwise().sum();
    const VectorXd spent = regression.spent(0, fitted, covariance);
    CHECK((spent - expected).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(spent.sum() == Approx(6));
    CHECK(spent.head(3).sum() > 4);
}

TEST_CASE("the noise estimate is unbiased in bins where many columns were fitted") {
    DFDYN_SEEDED_ENGINE(engine);
    const MeasuredMotion measured = swing(1);
    const SpectralRows rows(measured);
    const MatrixXd columns = slow_columns(measured, 6);
    const std::vector<Index> fitted{0, 1, 2, 3, 4, 5};
    constexpr int trials = 400;
    double estimated = 0;
    double naive = 0;
    for (int trial = 0; trial < trials; ++trial) {
        EffectRegression regression(rows, white_noise(measured.time_s.size(), 1, engine), rows.frames());
        set_columns(regression, columns);
        const WeightedSums sums = regression.weighted_sums();
        const MatrixXd left = regression.residual(0, solve_symmetric(sums.gram, sums.moment));
        const VectorXd spent = regression.spent(0, fitted, inverse_matrix(sums.gram));
        // Bin 5 is the first bin above those in which persistence is estimated.
        estimated += noise_spectrum(left, rows.filled(0), spent)[5] / trials;
        naive += noise_spectrum(left, rows.filled(0), VectorXd::Zero(rows.bins()))[5] / trials;
    }
    CHECK(estimated == Approx(1).epsilon(0.06));
    CHECK(naive < estimated);
}
