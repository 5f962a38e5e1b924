// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/six_equations.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <Eigen/Dense>

#include <limits>
#include <random>

namespace six_equations_test {

using dfdyn::hal::SixValues;
using Matrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
using Vector = Eigen::Matrix<double, 6, 1>;
using Rows = std::array<SixValues, 6>;

Rows rows_of(const Matrix& matrix) {
    Rows rows{};
    Eigen::Map<Matrix>(rows.front().data()) = matrix;
    return rows;
}

Matrix random_matrix(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return Matrix::NullaryExpr([&] { return normal(engine); });
}

TEST_CASE("six equations have the solution computed by Eigen") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 1000; ++i) {
        Matrix matrix = random_matrix(engine);
        // a zero pivot, so that rows must be exchanged
        matrix(i % 6, i % 6) = i % 2 == 0 ? 0 : matrix(i % 6, i % 6);
        const Vector right = random_matrix(engine).col(0);
        SixValues given{};
        Eigen::Map<Vector>(given.data()) = right;
        const auto found = dfdyn::hal::solve(rows_of(matrix), given);
        REQUIRE(found);
        const Vector expected = matrix.fullPivLu().solve(right);
        const double condition = matrix.norm() * matrix.inverse().norm();
        CHECK((Eigen::Map<const Vector>(found->data()) - expected).norm() <=
              1e-14 * condition * expected.norm());
    }
}

TEST_CASE("a singular matrix and one with an element that is not finite have no solution") {
    DFDYN_SEEDED_ENGINE(engine);
    const Matrix sound = random_matrix(engine);
    for (int row = 0; row < 6; ++row) {
        Matrix matrix = sound;
        matrix.row(row).setZero();
        CHECK_FALSE(dfdyn::hal::solve(rows_of(matrix), {}));
        for (int column = 0; column < 6; ++column) {
            for (const double bad :
                 {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
                matrix = sound;
                matrix(row, column) = bad;
                CHECK_FALSE(dfdyn::hal::solve(rows_of(matrix), {}));
            }
        }
    }
}

} // namespace six_equations_test
