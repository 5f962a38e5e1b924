// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/column_selection.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <cmath>
#include <vector>

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;

TEST_CASE("columns that are linear combinations of others are left out whatever their size") {
    const std::uint64_t seed = dfdyn::tests::seed() + GENERATE(range(0U, 5U));
    CAPTURE(seed);
    tools::NormalSource random(seed);
    MatrixXd psi = random.matrix(100, 6);
    psi.col(1) *= 1e-6;
    psi.col(2).setZero();
    psi.col(4) = 3 * psi.col(0) - 2e6 * psi.col(1);
    const tools::ColumnChoice choice = tools::select_columns(psi, 1e-6);
    // Any two of columns 0, 1 and 4 span the third.
    CHECK(choice.columns.size() == 4);
    for (std::size_t c = 0; c < choice.columns.size(); ++c) {
        CHECK(choice.columns[c] != 2);
        CHECK((c == 0 || choice.columns[c - 1] < choice.columns[c]));
        const auto column = choice.scale[static_cast<Index>(c)] * psi.col(choice.columns[c]);
        CHECK(std::sqrt(column.squaredNorm() / 100) == Approx(1));
    }
}

TEST_CASE("the threshold is the share of a column that the others do not explain") {
    tools::NormalSource random(dfdyn::tests::seed());
    MatrixXd psi = random.matrix(1000, 2);
    psi.col(0).normalize();
    psi.col(1) -= psi.col(0) * psi.col(0).dot(psi.col(1));
    psi.col(1) = psi.col(0) + 0.01 * psi.col(1).normalized();
    CHECK(tools::select_columns(psi, 0.0099).columns.size() == 2);
    CHECK(tools::select_columns(psi, 0.0101).columns.size() == 1);
    CHECK(tools::select_columns(MatrixXd::Zero(5, 3), 0.1).columns.empty());
}

TEST_CASE("a column of rounding errors is never selected however well it fits") {
    const std::uint64_t seed = dfdyn::tests::seed() + GENERATE(range(0U, 5U));
    CAPTURE(seed);
    tools::NormalSource random(seed);
    MatrixXd psi = random.matrix(300, 5);
    psi.col(3) *= 1e-15;
    CHECK(tools::select_columns(psi, 1e-3).columns == std::vector<Index>{0, 1, 2, 4});
    CHECK(tools::select_columns(1e-15 * psi, 1e-3).columns == std::vector<Index>{0, 1, 2, 4});
}

TEST_CASE("columns are weighted with the largest parameter of a machine") {
    tools::NormalSource random(dfdyn::tests::seed());
    MatrixXd psi = random.matrix(300, 3);
    for (Index c = 0; c < 3; ++c) {
        psi.col(c) *= std::sqrt(300) / psi.col(c).norm();
    }
    Eigen::VectorXd size{{1, 0.9 * tools::least_effect, 1.1 * tools::least_effect}};
    CHECK(tools::select_columns(psi, 1e-3, size).columns == std::vector<Index>{0, 2});
    psi.col(1) *= 2;
    psi.col(2) /= 2;
    CHECK(tools::select_columns(psi, 1e-3, size).columns == std::vector<Index>{0, 1});
    CHECK(tools::select_columns(psi, 1e-3).columns.size() == 3); // without any knowledge of the machine
}
