// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/motion.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"
#include "tools/model/inputs/derivative_rows.hpp"

#include <cmath>

namespace motion_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 6;
constexpr double period = 0.02;

/// Positions of a joint at a + b t + c t^2 / 2, newest first and at t = 0.
VectorXd parabola(double a, double b, double c) {
    const VectorXd time = -period * VectorXd::LinSpaced(lags + 1, 0, lags);
    return a + b * time.array() + c * time.array().square() / 2;
}

TEST_CASE("the filters of the physics give slope and curvature in physical units") {
    const double logit = GENERATE(-3.0, 0.0, 2.5);
    const auto rows = tools::difference_motion(lags, period, 0, true)->evaluate(VectorXd::Constant(2, logit));
    CHECK(rows.row(0).dot(parabola(2, 0, 0)) == Approx(0).margin(1e-9));
    CHECK(rows.row(0).dot(parabola(2, -3, 0)) == Approx(-3));
    CHECK(rows.row(1).dot(parabola(2, -3, 0)) == Approx(0).margin(1e-9));
    CHECK(rows.row(1).dot(parabola(2, -3, 5)) == Approx(5));
}

TEST_CASE("free rows give slope and curvature whatever their parameters are") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const auto motion = tools::free_motion(lags, period, 0);
    CHECK(motion->bounds().lower.size() == 2 * lags - 3);
    const MatrixXd rows = motion->evaluate(3 * random.matrix(2 * lags - 3, 1));
    CHECK(rows.row(0).dot(parabola(2, 0, 0)) == Approx(0).margin(1e-9));
    CHECK(rows.row(0).dot(parabola(2, -3, 0)) == Approx(-3));
    CHECK(rows.row(1).dot(parabola(2, -3, 0)) == Approx(0).margin(1e-9));
    CHECK(rows.row(1).dot(parabola(2, -3, 5)) == Approx(5));
}

TEST_CASE("the filters of the physics equal those of DFSR if the window is long") {
    constexpr double beta = 0.3;
    constexpr int many = 60;
    const VectorXd velocity = tools::mean_difference_row(1, beta, many);
    const VectorXd acceleration = tools::mean_difference_row(2, beta, many);
    CHECK((velocity - (1 - beta) * tools::filtered_velocity_row(beta, many)).norm() < 1e-12);
    CHECK((acceleration - (1 - beta) * tools::filtered_acceleration_row(beta, many)).norm() < 1e-12);
}

TEST_CASE("the polynomial of the physics is exact for parabolas") {
    const MatrixXd rows = tools::polynomial_motion(lags, period)->evaluate(VectorXd(0));
    CHECK(rows.row(0).dot(parabola(2, -3, 5)) == Approx(-3));
    CHECK(rows.row(1).dot(parabola(2, -3, 5)) == Approx(5));
}

TEST_CASE("the rows of DFR start in physical units") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    tools::TrainingData data = dfdyn::tests::arm_data(400, 2, 1, random);
    const tools::RowList all = dfdyn::tests::rows_between(lags, 400);
    const MatrixXd pooled = tools::LagSpread(data.positions, all, lags).pooled_factor();
    const auto family = dfdyn::tests::row_family(tools::InputKind::DFR, lags, 3, pooled);
    const auto motion = tools::lag_motion(
        data.positions, all, lags,
        tools::scaled_motion(dfdyn::tests::row_family(tools::InputKind::DFR, lags, 3, pooled), lags,
                             data.sample_period_s, pooled));
    const VectorXd input = family->start(0, random);
    VectorXd parameters(input.size() + 2);
    parameters << input, motion->start(input);
    const tools::MotionSamples samples = motion->evaluate(parameters);
    const MatrixXd velocities = data.velocities(all, Eigen::all);
    const MatrixXd accelerations = data.accelerations(all, Eigen::all);
    CHECK((samples.velocities - velocities).norm() < 0.35 * velocities.norm()); // a filter has a lag
    CHECK((samples.accelerations - accelerations).norm() < 0.35 * accelerations.norm());
    CHECK(samples.positions == data.positions(all, Eigen::all));
    CHECK(family->evaluate(input).rows.row(1).norm() == Approx(1));
}

TEST_CASE("the pull back of every motion equals finite differences") {
    const int kind = GENERATE(0, 1, 2, 3, 4);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(kind);
    tools::NormalSource random(dfdyn::tests::seed());
    const tools::TrainingData data = dfdyn::tests::arm_data(60, 2, 1, random);
    const tools::RowList rows = dfdyn::tests::rows_between(lags, 60, 3);
    const MatrixXd pooled = tools::LagSpread(data.positions, rows, lags).pooled_factor();
    std::unique_ptr<tools::MotionRows> motion_rows;
    Index inputs = 3;
    if (kind == 0) {
        motion_rows = tools::polynomial_motion(lags, period);
    } else if (kind == 1) {
        motion_rows = tools::difference_motion(lags, period, 1, false);
    } else if (kind == 2) {
        motion_rows = tools::difference_motion(lags, period, 3, true);
    } else if (kind == 3) {
        motion_rows = tools::free_motion(lags, period, 3);
    } else {
        motion_rows = tools::scaled_motion(dfdyn::tests::row_family(tools::InputKind::DFR, lags, 4, pooled),
                                           lags, period, pooled);
        inputs = 3 * (lags + 1);
    }
    const auto motion = tools::lag_motion(data.positions, rows, lags, std::move(motion_rows));
    const VectorXd parameters = random.matrix(inputs + motion->bounds().lower.size(), 1);
    const auto count = static_cast<Index>(rows.size());
    const tools::MotionGradient weights{random.matrix(count, 2), random.matrix(count, 2)};
    const auto sum = [&](const VectorXd& at) {
        const tools::MotionSamples samples = motion->evaluate(at);
        return samples.velocities.cwiseProduct(weights.velocities).sum() +
               samples.accelerations.cwiseProduct(weights.accelerations).sum();
    };
    const VectorXd truth = dfdyn::tests::differences(sum, parameters);
    CHECK((motion->pull_back(parameters, weights) - truth).norm() <= 1e-7 * truth.norm() + 1e-12);
    CHECK(motion->learns() == (kind != 0));
}

} // namespace motion_test
