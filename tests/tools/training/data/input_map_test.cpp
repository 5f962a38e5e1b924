// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/input_map.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/row_family.hpp"
#include "tests/tools/training/arm_data.hpp"

#include <array>
#include <cmath>

namespace input_map_test {

namespace tools = dfdyn::tools;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int lags = 4;

/// Three joints, the last of them held, and the rows after the first window.
struct Arm {
    tools::TrainingData data;
    tools::RowList rows = dfdyn::tests::rows_between(lags, 200);
    tools::NormalSource random{dfdyn::tests::seed()};

    Arm() {
        data = dfdyn::tests::arm_data(200, 3, 1, random);
        data.positions.col(2).setConstant(0.7);
        data.velocities.col(2).setZero();
        data.accelerations.col(2).setZero();
    }

    tools::LagSpread spread() const { return {data.positions, rows, lags}; }

    std::unique_ptr<tools::InputMap> map(int kind) const {
        if (kind >= 4) {
            return tools::derivative_input(data, rows, rows, spread(), kind == 4);
        }
        std::array<std::unique_ptr<tools::RowFamily>, 4> families{
            dfdyn::tests::row_family(tools::InputKind::DF, lags),
            dfdyn::tests::row_family(tools::InputKind::DFW, lags),
            dfdyn::tests::row_family(tools::InputKind::DFSR, lags),
            dfdyn::tests::row_family(tools::InputKind::DFR, lags, 4, spread().pooled_factor())};
        return tools::lag_input(data.positions, rows, spread(),
                                std::move(families[static_cast<std::size_t>(kind)]));
    }
};

MatrixXd centred(const MatrixXd& matrix) { return matrix.rowwise() - matrix.colwise().mean(); }

TEST_CASE("stored inputs equal the trained inputs up to a constant") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const int kind = GENERATE(0, 1, 2, 3, 4, 5);
    CAPTURE(kind);
    Arm arm;
    const auto map = arm.map(kind);
    const VectorXd parameters = map->start(5, arm.random);
    tools::InputModel model = map->model(parameters);
    model.lags = lags;
    const MatrixXd inputs = map->inputs(parameters);
    CHECK(inputs.cols() == 3 * model.rows_per_joint);
    const MatrixXd stored = tools::stored_inputs(model, arm.data, arm.rows);
    CHECK((centred(stored) - centred(inputs)).norm() < 1e-9 * inputs.norm());
}

TEST_CASE("the standard deviation of each input of a moving joint is its gain") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const int kind = GENERATE(0, 1, 2, 3, 4, 5);
    CAPTURE(kind);
    Arm arm;
    const auto map = arm.map(kind);
    const VectorXd parameters = map->start(5, arm.random);
    const MatrixXd inputs = centred(map->inputs(parameters));
    const VectorXd deviations = (inputs.colwise().norm() / std::sqrt(inputs.rows())).transpose();
    const Eigen::Index count = deviations.size() / 3;
    CHECK(deviations[0] == Approx(1));
    CHECK((deviations.segment(0, count) - deviations.segment(count, count)).norm() < 1e-6);
    CHECK(deviations.tail(count).maxCoeff() < 1e-12); // of the joint that is held
}

TEST_CASE("the scale of a joint that is held is its gain") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Arm arm;
    const auto df = arm.map(0)->model(VectorXd(0));
    for (std::size_t j = 0; j <= lags; ++j) {
        CHECK(df.scale[2 * (lags + 1) + j] == 1);
    }
    const auto standard = arm.map(4)->model(VectorXd{{std::log(2), std::log(3)}});
    CHECK(standard.rows.empty());
    CHECK(standard.scale[6] == 1);
    CHECK(standard.scale[7] == Approx(2));
    CHECK(standard.scale[8] == Approx(3));
}

TEST_CASE("stored DFSR rows are the paper's R with the stored alpha, scaled by unit-gain deviations") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Arm arm;
    const auto map = arm.map(2);
    const auto model = map->model(VectorXd{{std::log(5), std::log(0.2), 0, 1}});
    CHECK(model.rows[lags + 1] == Approx(5));             // alpha_1
    CHECK(model.rows[lags + 2] == Approx(5 * (0.5 - 1))); // alpha_1 (beta_1 - 1)
    CHECK(model.rows[2 * (lags + 1)] == Approx(0.2));     // alpha_2
    const auto unit = map->model(VectorXd{{0, 0, 0, 1}});
    for (std::size_t i = 0; i < unit.scale.size(); ++i) {
        CHECK(model.scale[i] == Approx(unit.scale[i]));
    }
}

TEST_CASE("stored DFW rows are the diagonal of the gains") {
    Arm arm;
    const auto model = arm.map(1)->model(VectorXd{{0.1, 0.2, 0.3, 0.4}});
    for (std::size_t lag = 0; lag <= lags; ++lag) {
        CHECK(model.rows[lag * (lags + 1) + lag] == Approx(std::exp(0.1 * static_cast<double>(lag))));
    }
    CHECK(model.rows[1] == 0);
}

TEST_CASE("STD without individual gains has inputs of unit deviation and no hyperparameters") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    Arm arm;
    const auto map = arm.map(5);
    const VectorXd parameters = map->start(5, arm.random);
    CHECK(parameters.size() == 0);
    CHECK(map->bounds().lower.size() == 0);
    const MatrixXd inputs = centred(map->inputs(parameters));
    const VectorXd deviations = (inputs.colwise().norm() / std::sqrt(inputs.rows())).transpose();
    CHECK((deviations.head(6) - VectorXd::Ones(6)).norm() < 1e-9); // of the joints that move
    CHECK(map->pull_back(parameters, inputs).size() == 0);
    const MatrixXd gains = arm.map(4)->inputs(VectorXd{{std::log(2), std::log(3)}});
    CHECK((gains.col(1) - 2 * map->inputs(parameters).col(1)).norm() < 1e-9);
}

} // namespace input_map_test
