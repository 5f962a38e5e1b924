// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/lag_window.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tests/tools/training/numerics.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace lag_window_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 4;

double naive_deviation(const MatrixXd& positions, const tools::RowList& rows, Eigen::Index joint,
                       const VectorXd& row) {
    const MatrixXd windows = tools::lag_windows(positions.col(joint), rows, static_cast<int>(row.size()) - 1);
    const VectorXd values = windows * row;
    return std::sqrt((values.array() - values.mean()).square().mean());
}

TEST_CASE("lag_windows contains the positions of each joint with the newest first") {
    const MatrixXd positions{{0, 100}, {1, 101}, {2, 102}, {3, 103}, {4, 104}};
    const MatrixXd expected{{2, 1, 0, 102, 101, 100}, {4, 3, 2, 104, 103, 102}};
    CHECK(tools::lag_windows(positions, {2, 4}, 2) == expected);
}

TEST_CASE("LagSpread gives the standard deviation of any row and its gradient") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    const MatrixXd positions = dfdyn::tests::arm_data(1500, 3, 1, random).positions;
    const tools::RowList rows = dfdyn::tests::rows_between(100, 1500); // more than two blocks
    const tools::LagSpread spread(positions, rows, lags);
    for (Eigen::Index joint = 0; joint < 3; ++joint) {
        const VectorXd row = random.matrix(lags + 1, 1);
        CHECK(spread.deviation(joint, row) ==
              Approx(naive_deviation(positions, rows, joint, row)).epsilon(1e-10));
        const auto deviation = [&](const VectorXd& at) { return spread.deviation(joint, at); };
        CHECK(dfdyn::tests::relative_error(spread.deviation_gradient(joint, row),
                                           dfdyn::tests::differences(deviation, row, 1e-4)) < 1e-7);
    }
}

TEST_CASE("LagSpread is accurate for second differences of a slow motion far from zero") {
    MatrixXd positions(2000, 1);
    for (Eigen::Index t = 0; t < 2000; ++t) {
        positions(t, 0) = 3 + std::sin(0.002 * static_cast<double>(t)); // second differences of 4e-6
    }
    const tools::RowList rows = dfdyn::tests::rows_between(2, 2000);
    const VectorXd row{{1, -2, 1}};
    const double deviation = tools::LagSpread(positions, rows, 2).deviation(0, row);
    CHECK(deviation == Approx(naive_deviation(positions, rows, 0, row)).epsilon(1e-7));
}

TEST_CASE("LagSpread treats joints that do not move as constant") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    MatrixXd positions = dfdyn::tests::arm_data(300, 4, 1, random).positions;
    positions.col(1).setConstant(0.3);
    for (Eigen::Index t = 0; t < 300; ++t) {
        positions(t, 2) = 1 + 1e-4 * static_cast<double>(t % 2); // a held joint whose encoder toggles
        positions(t, 3) = 0.01 * static_cast<double>(t);         // constant velocity
    }
    const tools::LagSpread spread(positions, dfdyn::tests::rows_between(2, 300), 2);
    const VectorXd position{{1, 0, 0}};
    const VectorXd velocity{{1, -1, 0}};
    CHECK(spread.deviation(0, position) > 0.1);
    CHECK(spread.deviation(1, position) == 0);
    CHECK(spread.deviation(2, position) == 0);
    CHECK(spread.deviation(2, velocity) == 0);
    CHECK(spread.deviation(3, position) > 0.1);
    CHECK(spread.deviation(3, velocity) == 0);
}

TEST_CASE("LagSpread scales a joint that moves far less than another, as a slide in metres") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    MatrixXd positions = dfdyn::tests::arm_data(600, 4, 1, random).positions;
    positions.col(1) *= 8e-4;                        // a slide of about 1 mm
    positions.col(2) = 3e-4 * random.matrix(600, 1); // a held joint with a noisy sensor
    for (Eigen::Index t = 0; t < 600; ++t) {
        positions(t, 3) = 1 + (t > 300 ? 3e-4 : 0); // a held joint that yields by one step of its encoder
    }
    const VectorXd position = VectorXd::Unit(lags + 1, 0);
    for (const int order : {2, lags}) {
        CAPTURE(order);
        const tools::RowList rows = dfdyn::tests::rows_between(order, 600);
        const tools::LagSpread spread(positions, rows, order);
        const VectorXd newest = position.head(order + 1);
        CHECK(spread.deviation(1, newest) ==
              Approx(naive_deviation(positions, rows, 1, newest)).epsilon(1e-10));
        CHECK(spread.deviation(2, newest) == 0);
        CHECK(spread.deviation(3, newest) == 0);
    }
}

TEST_CASE("LagSpread treats a joint as held that yields by 0.3 mrad, however fine its encoder") {
    MatrixXd positions(2000, 2);
    for (Eigen::Index t = 0; t < 2000; ++t) {
        const double phase = 0.01 * static_cast<double>(t);
        positions(t, 0) = 1.5 * std::sin(phase);
        positions(t, 1) = 1 + 6e-6 * std::round(50 * std::sin(1.1 * phase)); // 20 bits
    }
    const tools::RowList rows = dfdyn::tests::rows_between(lags, 2000);
    const VectorXd position = VectorXd::Unit(lags + 1, 0);
    const tools::LagSpread spread(positions, rows, lags);
    CHECK(spread.deviation(1, position) == 0);
    CHECK(spread.held_joints() == std::vector<std::size_t>{1});
    positions.col(0) /= 10; // beside a slower arm the same motion is not small
    CHECK(tools::LagSpread(positions, rows, lags).held_joints().empty());
    CHECK(tools::LagSpread(positions, rows, lags).deviation(1, position) > 1e-4);
}

TEST_CASE("the pooled factor measures rows in standard deviations of a typical joint") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::NormalSource random(dfdyn::tests::seed());
    MatrixXd positions = dfdyn::tests::arm_data(400, 3, 1, random).positions;
    positions.col(1).setConstant(1);
    const tools::LagSpread spread(positions, dfdyn::tests::rows_between(lags, 400), lags);
    const VectorXd position = VectorXd::Unit(lags + 1, 0);
    for (int i = 0; i < 5; ++i) {
        const VectorXd row = random.matrix(lags + 1, 1);
        const double ratio_0 = spread.deviation(0, row) / spread.deviation(0, position);
        const double ratio_2 = spread.deviation(2, row) / spread.deviation(2, position);
        const double expected = std::sqrt((ratio_0 * ratio_0 + ratio_2 * ratio_2) / 2);
        CHECK((spread.pooled_factor() * row).norm() == Approx(expected).epsilon(1e-5));
    }
    CHECK(spread.pooled_factor().diagonal().cwiseAbs().minCoeff() > 1e-7);
}

} // namespace lag_window_test
