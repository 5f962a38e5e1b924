// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"

#include "tests/support/catch.hpp"

namespace linear_algebra_test {

using dfdyn::tools::least_squares;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("least squares without columns have an empty solution") {
    CHECK(least_squares(MatrixXd(5, 0), VectorXd(VectorXd::Ones(5))).size() == 0);
    const MatrixXd several = least_squares(MatrixXd(5, 0), MatrixXd(MatrixXd::Ones(5, 3)));
    CHECK(several.rows() == 0);
    CHECK(several.cols() == 3);
}

} // namespace linear_algebra_test
