// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/search/hold_out.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <cmath>
#include <limits>

namespace hold_out_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index training = 40;

double relative_error(const MatrixXd& predicted, const MatrixXd& measured) {
    double sum = 0;
    for (Index k = 0; k < measured.cols(); ++k) {
        const VectorXd y = measured.col(k);
        sum += (predicted.col(k) - y).squaredNorm() / (y.array() - y.mean()).square().sum();
    }
    return sum / static_cast<double>(measured.cols());
}

TEST_CASE("the hold-out error of a kernel is the error of its prediction of unseen samples") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd inputs = random.matrix(60, 2);
    MatrixXd outputs(60, 2);
    outputs << inputs.rowwise().sum().array().sin(), inputs.col(0).array().cos();
    outputs += 0.1 * random.matrix(60, 2);
    const auto points = tools::hold_out_kernel(inputs, outputs, training);
    CHECK(points.size() == 169);
    for (const std::size_t i : {std::size_t{60}, std::size_t{75}, std::size_t{168}}) {
        const tools::HoldOutPoint& point = points.at(i);
        MatrixXd kernel(60, 60);
        for (Index s = 0; s < 60; ++s) {
            for (Index t = 0; t < 60; ++t) {
                const double distance = (inputs.row(s) - inputs.row(t)).norm() / point.length_scale;
                kernel(s, t) = std::exp(-distance * distance / 2);
            }
        }
        const MatrixXd seen = kernel.topLeftCorner(training, training) +
                              point.noise_ratio * MatrixXd::Identity(training, training);
        const MatrixXd predicted =
            kernel.bottomLeftCorner(20, training) * tools::inverse_matrix(seen) * outputs.topRows(training);
        CHECK(point.error == Approx(relative_error(predicted, outputs.bottomRows(20))).epsilon(1e-6));
    }
    const tools::HoldOutPoint& best = tools::best_point(points);
    for (const tools::HoldOutPoint& point : points) {
        CHECK(point.error >= best.error);
    }
    CHECK(best.error < 0.3);
    CHECK(best.noise_ratio > 1e-5); // recognises the noise
}

TEST_CASE("the hold-out error of physics is the error of ridge regression") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd columns = random.matrix(60, 8); // two outputs, four parameters
    const VectorXd truth = random.matrix(4, 1);
    MatrixXd outputs(60, 2);
    outputs << columns.leftCols(4) * truth, columns.rightCols(4) * truth;
    outputs += random.matrix(60, 2) * VectorXd{{0.1, 0.4}}.asDiagonal();
    const auto points = tools::hold_out_physics(columns, outputs, training);
    REQUIRE(points);
    // Weak priors give weighted least squares, with weights from its own residuals.
    MatrixXd design(2 * training, 4);
    design << columns.topLeftCorner(training, 4), columns.topRightCorner(training, 4);
    VectorXd weights = VectorXd::Ones(2 * training);
    VectorXd parameters;
    const VectorXd y = outputs.topRows(training).reshaped();
    for (int i = 0; i < 50; ++i) {
        parameters = tools::inverse_matrix(design.transpose() * weights.asDiagonal() * design) *
                     design.transpose() * weights.asDiagonal() * y;
        const VectorXd residual = y - design * parameters;
        weights.head(training).setConstant(training / residual.head(training).squaredNorm());
        weights.tail(training).setConstant(training / residual.tail(training).squaredNorm());
    }
    MatrixXd predicted(20, 2);
    predicted << columns.bottomLeftCorner(20, 4) * parameters, columns.bottomRightCorner(20, 4) * parameters;
    CHECK(points->back().error == Approx(relative_error(predicted, outputs.bottomRows(20))).epsilon(1e-4));
    CHECK(points->front().error > 0.5); // the prior keeps the parameters at zero
    CHECK(tools::best_point(*points).error <= points->back().error);
}

TEST_CASE("a covariance that cannot be factored has an infinite error and is not the best point") {
    const MatrixXd inputs = MatrixXd::Constant(20, 1, std::numeric_limits<double>::quiet_NaN());
    const auto points = tools::hold_out_kernel(inputs, MatrixXd::Random(20, 1), 10);
    CHECK(std::isinf(tools::best_point(points).error));
}

TEST_CASE("a point is at the edge of a grid only in coordinates that vary") {
    std::vector<tools::HoldOutPoint> grid;
    for (const double length_scale : {1.0, 2.0, 4.0}) {
        for (const double noise_ratio : {0.1, 0.2, 0.3}) {
            grid.push_back({length_scale, noise_ratio, 0, 1});
        }
    }
    for (const tools::HoldOutPoint& point : grid) {
        CHECK(tools::at_edge(point, grid) == (point.length_scale != 2 || point.noise_ratio != 0.2));
    }
    const std::vector<tools::HoldOutPoint> line{{0, 0, 1, 1}, {0, 0, 2, 1}, {0, 0, 3, 1}};
    CHECK(tools::at_edge(line[0], line));
    CHECK_FALSE(tools::at_edge(line[1], line));
    CHECK(tools::at_edge(line[2], line));
}

} // namespace hold_out_test
