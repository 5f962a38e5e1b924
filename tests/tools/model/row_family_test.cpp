// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/row_family.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/model/inputs/derivative_rows.hpp"

#include <cmath>

namespace row_family_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 5;

/// A regular upper triangular matrix with elements of different sizes.
MatrixXd pooled_factor(tools::NormalSource& random) {
    MatrixXd factor = random.matrix(lags + 1, lags + 1).triangularView<Eigen::Upper>();
    factor.diagonal() = VectorXd::LinSpaced(lags + 1, 1, 0.05);
    return factor;
}

TEST_CASE("DF rows are the identity without parameters") {
    tools::NormalSource random(1);
    const auto family = dfdyn::tests::row_family(tools::InputKind::DF, lags);
    CHECK(family->bounds().lower.size() == 0);
    const tools::InputRows rows = family->evaluate(family->start(0, random));
    CHECK(rows.rows == MatrixXd::Identity(lags + 1, lags + 1));
    CHECK(rows.gain == VectorXd::Ones(lags + 1));
}

TEST_CASE("DFW rows are a diagonal whose first gain is one") {
    const auto family = dfdyn::tests::row_family(tools::InputKind::DFW, lags);
    const VectorXd parameters = VectorXd::LinSpaced(lags, -1, 1);
    const tools::InputRows rows = family->evaluate(parameters);
    CHECK(rows.rows == MatrixXd::Identity(lags + 1, lags + 1));
    CHECK(rows.gain[0] == 1);
    CHECK(rows.gain[1] == Approx(std::exp(-1)));
    CHECK(rows.gain[lags] == Approx(std::exp(1)));
    CHECK(family->stored_gain(rows) == rows.gain);
}

TEST_CASE("DFSR rows are those of the paper with poles and gains in their ranges") {
    const auto family = dfdyn::tests::row_family(tools::InputKind::DFSR, lags);
    const VectorXd parameters{{0.3, -0.7, 0, std::log(3)}};
    const tools::InputRows rows = family->evaluate(parameters);
    CHECK(rows.rows.row(0) == VectorXd::Unit(lags + 1, 0).transpose());
    CHECK((rows.rows.row(1).transpose() - tools::filtered_velocity_row(0.5, lags)).norm() < 1e-14);
    CHECK((rows.rows.row(2).transpose() - tools::filtered_acceleration_row(0.75, lags)).norm() < 1e-14);
    CHECK(rows.gain.isApprox(VectorXd{{1, std::exp(0.3), std::exp(-0.7)}}));
    tools::InputModel model;
    family->describe(parameters, model);
    CHECK(model.alpha == std::array{std::exp(0.3), std::exp(-0.7)});
    CHECK(model.beta[0] == Approx(0.5));
    CHECK(model.beta[1] == Approx(0.75));
    CHECK(family->stored_gain(rows) == rows.gain);
}

TEST_CASE("DFR rows have length one and the first is the position") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const int count = GENERATE(1, 2, 3, 5);
    const MatrixXd factor = pooled_factor(random);
    const auto family = dfdyn::tests::row_family(tools::InputKind::DFR, lags, count, factor);
    const VectorXd parameters = random.matrix((count - 1) * (lags + 1), 1);
    const tools::InputRows rows = family->evaluate(parameters);
    CHECK(rows.rows.rows() == count);
    CHECK(rows.rows.row(0) == VectorXd::Unit(lags + 1, 0).transpose());
    CHECK(rows.gain[0] == 1);
    CHECK((rows.rows.rowwise().norm().array() - 1).abs().maxCoeff() < 1e-14);
    for (Eigen::Index j = 1; j < count; ++j) {
        const VectorXd theta = parameters.segment((j - 1) * (lags + 1), lags + 1);
        CHECK(rows.gain[j] == Approx(theta.norm()));
        CHECK((factor * rows.rows.row(j).transpose()).normalized().isApprox(theta.normalized(), 1e-10));
    }
    CHECK(family->stored_gain(rows) == VectorXd::Ones(count));
}

TEST_CASE("DFR starts from differentiators of increasing order and then from perturbed ones") {
    tools::NormalSource random(7);
    const MatrixXd factor = pooled_factor(random);
    const auto family = dfdyn::tests::row_family(tools::InputKind::DFR, lags, 3, factor);
    VectorXd velocity(lags + 1); // windows of q = t and q = t^2 / 2, newest first
    VectorXd acceleration(lags + 1);
    for (int lag = 0; lag <= lags; ++lag) {
        velocity[lag] = -lag;
        acceleration[lag] = 0.5 * lag * lag;
    }
    for (const int index : {0, 2}) {
        const MatrixXd rows = family->evaluate(family->start(index, random)).rows;
        CHECK(std::abs(rows.row(1).sum()) < 1e-9);
        CHECK(std::abs(rows.row(2).sum()) < 1e-9);
        CHECK(rows.row(1).dot(velocity) > 0.1);
        CHECK(std::abs(rows.row(2).dot(velocity)) < 1e-9);
        CHECK(rows.row(2).dot(acceleration) > 0.1);
    }
    const MatrixXd filtered = family->evaluate(family->start(1, random)).rows;
    CHECK(filtered.row(1).isApprox(tools::filtered_velocity_row(0.4, lags).normalized().transpose(), 1e-9));
    CHECK(
        filtered.row(2).isApprox(tools::filtered_acceleration_row(0.4, lags).normalized().transpose(), 1e-9));
    CHECK((family->start(3, random) - family->start(3, random)).norm() > 0.1);
}

TEST_CASE("all starts are within the bounds") {
    tools::NormalSource random(7);
    const MatrixXd factor = pooled_factor(random);
    for (const auto& family : {dfdyn::tests::row_family(tools::InputKind::DF, lags),
                               dfdyn::tests::row_family(tools::InputKind::DFW, lags),
                               dfdyn::tests::row_family(tools::InputKind::DFSR, lags),
                               dfdyn::tests::row_family(tools::InputKind::DFR, lags, 6, factor)}) {
        for (int index = 0; index < 8; ++index) {
            const VectorXd parameters = family->start(index, random);
            REQUIRE(parameters.size() == family->bounds().lower.size());
            CHECK((parameters.array() > family->bounds().lower.array()).all());
            CHECK((parameters.array() < family->bounds().upper.array()).all());
        }
    }
}

} // namespace row_family_test
