// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/covariance_factor.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace covariance_factor_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;

MatrixXd random_covariance(Eigen::Index size) {
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd root = random.matrix(size, size);
    return root * root.transpose() + MatrixXd::Identity(size, size);
}

TEST_CASE("CovarianceFactor gives inverse and solution and determinant for sizes around its block size") {
    const Eigen::Index size = GENERATE(1, 2, 47, 48, 49, 96, 97, 150);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(size);
    const MatrixXd covariance = random_covariance(size);
    const auto factor = tools::CovarianceFactor::of(covariance);
    REQUIRE(factor);
    const Eigen::PartialPivLU<MatrixXd> truth(covariance);
    const MatrixXd inverse = truth.inverse();
    CHECK((factor->inverse() - inverse).norm() < 1e-10 * inverse.norm());
    CHECK(factor->inverse() == factor->inverse().transpose());
    const MatrixXd sides = MatrixXd::Random(size, 3);
    CHECK((factor->solve(sides) - inverse * sides).norm() < 1e-10 * (inverse * sides).norm());
    const double log_determinant =
        truth.matrixLU().diagonal().array().abs().log().sum(); // the product of the diagonal would overflow
    CHECK(factor->log_determinant() == Approx(log_determinant).epsilon(1e-12));
}

TEST_CASE("CovarianceFactor rejects a matrix that is not a covariance") {
    MatrixXd covariance = random_covariance(60);
    SECTION("negative") { covariance(50, 50) = -1; }
    SECTION("not a number") { covariance(50, 50) = std::numeric_limits<double>::quiet_NaN(); }
    SECTION("not a number off the diagonal") { covariance(50, 3) = std::numeric_limits<double>::quiet_NaN(); }
    SECTION("infinite") { covariance(50, 50) = std::numeric_limits<double>::infinity(); }
    SECTION("singular") { covariance = MatrixXd::Ones(60, 60); }
    CHECK_FALSE(tools::CovarianceFactor::of(covariance));
}

} // namespace covariance_factor_test
