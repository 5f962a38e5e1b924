// SPDX-License-Identifier: Apache-2.0
// Random effects: parameters drawn from the model that `pool` fits, so that the truth is known.
#include "tools/diagnosis/recordings/pooled_fit.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/QR>

#include <cmath>
#include <random>
#include <stdexcept>

namespace pooled_fit_test {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index parameters = 4;

/// Two parameters whose spread is a tenth of their size, and two with a spread of 0.2; four groups.
PooledPrior wide_prior() {
    PooledPrior prior;
    prior.covariance = 1e4 * MatrixXd::Identity(parameters, parameters);
    prior.relative_spread = (VectorXd(parameters) << 0.1, 0.1, 0, 0).finished();
    prior.least_spread = (VectorXd(parameters) << 1e-3, 1e-3, 0.2, 0.2).finished();
    prior.spread_of = {0, 1, 2, 3};
    prior.group = {0, 1, 2, 3};
    return prior;
}

/// A recording of `rows` measurements with noise of 1 and random columns.
RecordingInformation recording_of(const VectorXd& truth, Index rows, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    const MatrixXd columns = MatrixXd::NullaryExpr(rows, parameters, [&] { return normal(engine); });
    const VectorXd noise = VectorXd::NullaryExpr(rows, [&] { return normal(engine); });
    return {columns.transpose() * columns, columns.transpose() * (columns * truth + noise)};
}

VectorXd scattered(const VectorXd& value, const VectorXd& spread, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return value + spread.cwiseProduct(VectorXd::NullaryExpr(parameters, [&] { return normal(engine); }));
}

TEST_CASE("the standard deviations of the common values and of each recording's values are right") {
    DFDYN_SEEDED_ENGINE(engine);
    const VectorXd value = (VectorXd(parameters) << 5, -3, 0.5, 1).finished();
    const VectorXd spread = (VectorXd(parameters) << 0.5, 0.3, 0.2, 0.2).finished();
    constexpr int arms = 60;
    constexpr std::size_t recordings = 5;
    double common = 0, own = 0;
    for (int arm = 0; arm < arms; ++arm) {
        std::vector<RecordingInformation> all;
        std::vector<VectorXd> truths;
        for (std::size_t r = 0; r < recordings; ++r) {
            truths.push_back(scattered(value, spread, engine));
            all.push_back(recording_of(truths.back(), 40, engine));
        }
        const PooledFit fit = pool(all, wide_prior());
        common += (fit.value - value).cwiseQuotient(fit.covariance.diagonal().cwiseSqrt()).squaredNorm();
        for (std::size_t r = 0; r < recordings; ++r) {
            own +=
                (fit.value + fit.difference[r] - truths[r]).cwiseQuotient(fit.own_deviation[r]).squaredNorm();
        }
    }
    CHECK(common / (arms * parameters) == Approx(1).epsilon(0.35));
    CHECK(own / (arms * parameters * static_cast<double>(recordings)) == Approx(1).epsilon(0.25));
}

TEST_CASE("the spread follows the data with many recordings and the prior with two") {
    DFDYN_SEEDED_ENGINE(engine);
    const VectorXd value = (VectorXd(parameters) << 5, -3, 0.5, 1).finished();
    const VectorXd spread = (VectorXd(parameters) << 2, 0.1, 0.2, 1).finished();
    std::vector<RecordingInformation> all;
    for (int r = 0; r < 60; ++r) {
        all.push_back(recording_of(scattered(value, spread, engine), 2000, engine));
    }
    const PooledFit many = pool(all, wide_prior());
    const VectorXd expected = (VectorXd(parameters) << 0.5, 0.3, 0.2, 0.2).finished();
    const VectorXd with_prior = ((3 * expected.cwiseAbs2() + 60 * spread.cwiseAbs2()) / 63).cwiseSqrt();
    for (Index k = 0; k < parameters; ++k) {
        CHECK(many.spread[k] == Approx(with_prior[k]).epsilon(0.3));
    }
    all.resize(2);
    const PooledFit two = pool(all, wide_prior());
    CHECK(two.spread[1] > 0.15);
    CHECK(two.spread[1] < 0.35);
}

TEST_CASE("the same recording twice gives the same value and not less than half of the interval") {
    DFDYN_SEEDED_ENGINE(engine);
    const VectorXd value = (VectorXd(parameters) << 5, -3, 0.5, 1).finished();
    const RecordingInformation one = recording_of(value, 40, engine);
    const PooledFit once = pool({one}, wide_prior());
    const PooledFit twice = pool({one, one}, wide_prior());
    CHECK((once.value - twice.value).cwiseAbs().maxCoeff() < 1e-3);
    const auto width = [](const PooledFit& fit) -> VectorXd {
        return (fit.covariance.diagonal() + fit.spread.cwiseAbs2()).cwiseSqrt();
    };
    CHECK((width(twice).array() >= 0.5 * width(once).array()).all());
    CHECK((width(twice).array() <= width(once).array()).all());
}

TEST_CASE("a parameter that changes has its own value in each recording") {
    DFDYN_SEEDED_ENGINE(engine);
    const VectorXd value = (VectorXd(parameters) << 5, -3, 0.5, 1).finished();
    VectorXd other = value;
    other[3] = 9;
    const std::vector<RecordingInformation> all{recording_of(value, 1000, engine),
                                                recording_of(other, 1000, engine)};
    PooledPrior prior = wide_prior();
    const double common = pool(all, prior).evidence;
    MatrixXd changed = MatrixXd::Zero(parameters, parameters);
    changed(3, 3) = 100;
    prior.changed = {changed, changed};
    const PooledFit fit = pool(all, prior);
    CHECK(fit.evidence > common + 3);
    CHECK(fit.value[3] + fit.difference[0][3] == Approx(1).margin(0.2));
    CHECK(fit.value[3] + fit.difference[1][3] == Approx(9).margin(0.2));
    CHECK(fit.spread[3] < 0.4); // not taken for spread
}

TEST_CASE("the evidence is the marginal normal density") {
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> normal;
    PooledPrior prior = wide_prior();
    prior.covariance = MatrixXd::Identity(parameters, parameters);
    prior.relative_spread.setZero();
    std::vector<RecordingInformation> all;
    std::vector<MatrixXd> columns;
    std::vector<VectorXd> measured;
    for (int r = 0; r < 2; ++r) {
        const MatrixXd& x =
            columns.emplace_back(MatrixXd::NullaryExpr(6, parameters, [&] { return normal(engine); }));
        const VectorXd& y = measured.emplace_back(VectorXd::NullaryExpr(6, [&] { return normal(engine); }));
        all.push_back({x.transpose() * x, x.transpose() * y});
    }
    const auto density = [&](const PooledFit& fit) {
        MatrixXd covariance = MatrixXd::Identity(12, 12);
        VectorXd both(12);
        for (Index r = 0; r < 2; ++r) {
            both.segment<6>(6 * r) = measured[static_cast<std::size_t>(r)];
            for (Index s = 0; s < 2; ++s) {
                MatrixXd between = prior.covariance;
                if (r == s) {
                    between.diagonal() += fit.spread.cwiseAbs2();
                }
                covariance.block<6, 6>(6 * r, 6 * s) += columns[static_cast<std::size_t>(r)] * between *
                                                        columns[static_cast<std::size_t>(s)].transpose();
            }
        }
        const Eigen::ArrayXd ratio = fit.ratio.array();
        const double of_spread = -3 * (ratio.log() + 0.5 * ratio.square().inverse()).sum();
        return of_spread - 0.5 * both.dot(covariance.colPivHouseholderQr().solve(both)) -
               0.5 * covariance.colPivHouseholderQr().logAbsDeterminant() + 0.5 * both.squaredNorm();
    };
    const PooledFit narrow = pool(all, prior);
    prior.covariance *= 4;
    const PooledFit wide = pool(all, prior);
    const double by_pool = wide.evidence - narrow.evidence;
    const double wide_density = density(wide);
    prior.covariance /= 4;
    CHECK(by_pool == Approx(wide_density - density(narrow)).margin(1e-6));
}

TEST_CASE("no recordings are an error") { CHECK_THROWS_AS(pool({}, wide_prior()), std::logic_error); }

} // namespace pooled_fit_test
