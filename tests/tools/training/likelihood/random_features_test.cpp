// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/random_features.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/random_source.hpp"
#include "tools/training/likelihood/gaussian_kernel.hpp"

#include <cmath>

namespace random_features_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int inputs = 6;

MatrixXd sample_points() { return tools::NormalSource(dfdyn::tests::seed()).matrix(15, inputs); }

/// Sum over pairs of points, averaged over 40 draws, of the squared error of the kernel.
double mean_square_error(int count, bool orthogonal, double length_scale) {
    const MatrixXd points = sample_points();
    const MatrixXd kernel = tools::gaussian_kernel(points, length_scale);
    constexpr int draws = 40;
    double sum = 0;
    for (std::uint64_t draw = 0; draw < draws; ++draw) {
        const auto model =
            tools::draw_features(count, inputs, orthogonal, length_scale, 1000 * dfdyn::tests::seed() + draw);
        const MatrixXd features = tools::random_features(model, points);
        sum += (features * features.transpose() - kernel).squaredNorm();
    }
    return sum / draws;
}

/// Theoretical value for independent frequencies: the variance of a pair is (1 - K^2)^2 / (2 d).
double expected_square_error(int count, double length_scale) {
    const MatrixXd kernel = tools::gaussian_kernel(sample_points(), length_scale);
    return (1 - kernel.array().square()).square().sum() / (2.0 * count);
}

TEST_CASE("the kernel error of random features is as theory predicts") {
    const int count = GENERATE(50, 200, 800);
    const double length_scale = GENERATE(1.5, 3.0);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(count, length_scale);
    const double ratio =
        mean_square_error(count, false, length_scale) / expected_square_error(count, length_scale);
    CHECK(ratio > 0.6);
    CHECK(ratio < 1.5);
}

TEST_CASE("orthogonal random features approximate the kernel better") {
    const int count = GENERATE(48, 250); // whole blocks; an incomplete block
    const double length_scale = GENERATE(2.0, 4.0);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(count, length_scale);
    CHECK(mean_square_error(count, true, length_scale) < 0.8 * expected_square_error(count, length_scale));
}

TEST_CASE("orthogonal frequencies are orthogonal in blocks and as long as independent ones") {
    constexpr int count = 6000;
    const auto model = tools::draw_features(count, inputs, true, 1, 5);
    const Eigen::Map<const RowMajor> omega(model.omega.data(), count, inputs);
    for (Eigen::Index first : {0, inputs, 30 * inputs}) {
        const MatrixXd block = omega.middleRows(first, inputs);
        MatrixXd products = block * block.transpose();
        products.diagonal().setZero();
        CHECK(products.cwiseAbs().maxCoeff() < 1e-12);
    }
    const Eigen::ArrayXd squares = omega.rowwise().squaredNorm();
    CHECK(std::abs(squares.mean() - inputs) <
          4 * std::sqrt(2.0 * inputs / count)); // chi-squared: mean 6, variance 12
    CHECK((squares - squares.mean()).square().mean() == Approx(2.0 * inputs).epsilon(0.15));
    CHECK(std::abs(omega.mean()) < 4 / std::sqrt(count * inputs)); // symmetric about zero
}

TEST_CASE("a feature vector has length one and its cosines come before its sines") {
    const auto model = tools::draw_features(7, inputs, true, 2, 1);
    const MatrixXd points = sample_points();
    const MatrixXd features = tools::random_features(model, points);
    CHECK(features.cols() == 14);
    CHECK((features.rowwise().norm().array() - 1).abs().maxCoeff() < 1e-14);
    const Eigen::Map<const RowMajor> omega(model.omega.data(), 7, inputs);
    const double phase = omega.row(3).dot(points.row(4)) / 2;
    CHECK(features(4, 3) == Approx(std::cos(phase) / std::sqrt(7)));
    CHECK(features(4, 7 + 3) == Approx(std::sin(phase) / std::sqrt(7)));
}

TEST_CASE("frequencies depend on the seed alone") {
    const bool orthogonal = GENERATE(false, true);
    const auto omega = [&](std::uint64_t seed) {
        return tools::draw_features(20, inputs, orthogonal, 1, seed).omega;
    };
    CHECK(omega(1) == omega(1));
    CHECK(omega(1) != omega(2));
}

} // namespace random_features_test
