// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/row_selection.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/training/arm_data.hpp"

#include <algorithm>
#include <cmath>

namespace tools = dfdyn::tools;
using dfdyn::tests::rows_between;
using tools::RowList;

TEST_CASE("usable rows have a complete window without a gap") {
    CHECK(tools::usable_rows({1, 0, 0, 0, 1, 0, 1, 0, 0}, 2) == RowList{2, 3, 8});
    CHECK(tools::usable_rows({0, 0, 0}, 2) == RowList{2}); // there is no row before the first
    CHECK(tools::usable_rows({1, 1, 0}, 1) == RowList{2});
    CHECK(tools::usable_rows({1, 0}, 5).empty());
    CHECK(tools::usable_rows({}, 1).empty());
}

TEST_CASE("rows are at rest if no joint moves in their window") {
    Eigen::MatrixXd positions = Eigen::MatrixXd::Zero(100, 2);
    for (Eigen::Index t = 0; t < 100; ++t) {
        positions(t, 0) = 1e-5 * static_cast<double>(t % 2); // toggling of the encoder
        positions(t, 1) = t < 60 ? 0 : std::sin(0.1 * static_cast<double>(t - 59));
    }
    const tools::MotionSplit split = tools::split_by_motion(positions, rows_between(3, 100), 3);
    CHECK(split.still == rows_between(3, 60));
    CHECK(split.moving == rows_between(60, 100));
}

TEST_CASE("a row at the reversal of a joint is in motion") {
    Eigen::MatrixXd positions(41, 1);
    for (Eigen::Index t = 0; t < 41; ++t) {
        positions(t, 0) =
            std::abs(static_cast<double>(t) - 20); // equal at both ends of the window that ends at row 22
    }
    CHECK(tools::split_by_motion(positions, rows_between(4, 41), 4).still.empty());
}

TEST_CASE("an arm that never moves has no rows in motion") {
    const tools::MotionSplit split =
        tools::split_by_motion(Eigen::MatrixXd::Ones(30, 2), rows_between(3, 30), 3);
    CHECK(split.moving.empty());
    CHECK(split.still.size() == 27);
}

TEST_CASE("likelihood rows are spread over the motion with few rows at rest") {
    const tools::MotionSplit split{rows_between(1000, 2000), rows_between(0, 1000)};
    const RowList rows = tools::likelihood_rows(split, 100);
    CHECK(rows.size() == 100);
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    const auto still = std::count_if(rows.begin(), rows.end(), [](Eigen::Index row) { return row < 1000; });
    CHECK(still == 5);
    for (std::size_t i = 6; i < rows.size(); ++i) {
        const Eigen::Index step = rows[i] - rows[i - 1];
        CHECK((step == 10 || step == 11)); // 95 of 1000 rows in motion
    }
}

TEST_CASE("likelihood rows are all rows in motion if there are few") {
    const RowList rows = tools::likelihood_rows({rows_between(500, 540), rows_between(0, 500)}, 1000);
    CHECK(std::count_if(rows.begin(), rows.end(), [](Eigen::Index row) { return row >= 500; }) == 40);
    CHECK(rows.size() == 42);
}

TEST_CASE("likelihood rows of an arm that never rests are all in motion") {
    CHECK(tools::likelihood_rows({rows_between(0, 50), {}}, 100) == rows_between(0, 50));
    CHECK(tools::likelihood_rows({rows_between(0, 50), {}}, 25).size() == 25);
}
