// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/lag_spacing.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/search/training_setup.hpp"
#include "tools/training/train.hpp"

#include <algorithm>
#include <utility>

namespace lag_spacing_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;

tools::TrainingData noisy_data(Index samples) {
    tools::NormalSource random(3);
    tools::TrainingData data = dfdyn::tests::arm_data(samples, 2, 2, random);
    data.positions += 0.01 * random.matrix(samples, 2);
    data.gap_before[static_cast<std::size_t>(samples) / 2] = 1;
    return data;
}

TEST_CASE("the spacing of a window follows the sample period") {
    const auto found = [](double window_s, double period_s) {
        const tools::LagSpacing spacing = tools::spacing_of(window_s, period_s);
        return std::pair{spacing.lags, spacing.every};
    };
    CHECK(found(0.08, 0.02) == std::pair{4, 1});
    CHECK(found(0.08, 0.008) == std::pair{10, 1});
    CHECK(found(0.08, 0.002) == std::pair{20, 2});
    CHECK(found(0.08, 0.001) == std::pair{20, 4});
    CHECK(found(0.08, 0.0002) == std::pair{20, 20});
    CHECK(found(1e-6, 0.01) == std::pair{2, 1});
    for (const double period_s : {0.02, 0.011, 0.008, 0.0053, 0.001, 0.0002}) {
        const tools::LagSpacing spacing = tools::spacing_of(0.24, period_s);
        CHECK(spacing.lags <= 20);
        CHECK(spacing.lags * spacing.every * period_s == Approx(0.24).epsilon(0.06));
    }
}

// The inputs of training and of the estimator must be the same numbers.
TEST_CASE("inputs of spaced positions equal those of the dense rows at every sample") {
    const int every = GENERATE(2, 5);
    const int lags = 3;
    const tools::TrainingData data = noisy_data(101);
    const tools::TrainingData spaced = tools::spaced_data(data, every);
    CHECK(spaced.sample_period_s == Approx(every * data.sample_period_s));
    tools::InputModel input;
    input.kind = tools::InputKind::DFR;
    input.lags = lags;
    input.rows_per_joint = 3;
    input.rows = {1, 0, 0, 0, 0.5, -0.5, 0, 0, 1, -2, 1, 0.25};
    input.scale = {1, 2, 3, 4, 5, 6};
    const tools::RowList spaced_rows = tools::usable_rows(spaced.gap_before, lags);
    const MatrixXd seen = tools::stored_inputs(input, spaced, spaced_rows);
    const tools::InputModel dense = tools::dense_input(input, every);
    CHECK(dense.lags == tools::dense_lags({lags, every}));
    const tools::RowList rows = tools::usable_rows(data.gap_before, dense.lags);
    const MatrixXd computed = tools::stored_inputs(dense, data, rows);
    REQUIRE(seen.rows() == computed.rows()); // each tick of the estimator is a row of training
    for (Index row = 0; row < seen.rows(); ++row) {
        // An output belongs to only one sample, so it identifies the tick.
        const auto same = [&](Index tick) {
            return data.outputs.row(tick) == spaced.outputs.row(spaced_rows[static_cast<std::size_t>(row)]);
        };
        const auto tick = std::find_if(rows.begin(), rows.end(), same);
        REQUIRE(tick != rows.end());
        CHECK((seen.row(row) - computed.row(tick - rows.begin())).cwiseAbs().maxCoeff() < 1e-12);
    }
}

TEST_CASE("a spacing of one changes nothing") {
    const tools::TrainingData data = noisy_data(50);
    const tools::TrainingData spaced = tools::spaced_data(data, 1);
    CHECK(spaced.positions == data.positions);
    CHECK(spaced.gap_before == data.gap_before);
}

TEST_CASE("the start of learning gets the rows of interleaved samples in order of time") {
    const tools::TrainingData data = noisy_data(400); // with a gap
    const tools::TrainingData spaced = tools::spaced_data(data, 4);
    tools::TrainingOptions options;
    options.lags = 3;
    options.likelihood_rows = 60;
    const tools::RowList rows = tools::choose_rows(spaced, options).usable;
    REQUIRE(rows.size() > 300);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows[i]);
        CHECK(spaced.outputs.row(rows[i]) == data.outputs.row(spaced.time_order[row]));
        CHECK((i == 0 || spaced.time_order[row] > spaced.time_order[static_cast<std::size_t>(rows[i - 1])]));
    }
}

TEST_CASE("an arm that does not move has no gaps because its samples are interleaved") {
    tools::TrainingData data = noisy_data(400);
    data.positions.setZero();
    data.gap_before.assign(data.gap_before.size(), 0);
    data.gap_before.front() = 1;
    tools::TrainingOptions options;
    options.lags = 3;
    CHECK_THROWS_WITH(tools::choose_rows(tools::spaced_data(data, 4), options),
                      Catch::Matchers::EndsWith("rows before them without a gap, found 0"));
}

TEST_CASE("inputs DF, DFW and DFSR become free rows when spaced") {
    for (const tools::InputKind kind :
         {tools::InputKind::DF, tools::InputKind::DFW, tools::InputKind::DFSR}) {
        tools::TrainingOptions options;
        options.input = kind;
        options.lags = 3;
        options.every = 4;
        options.feature_count = 10;
        options.likelihood_rows = 60;
        options.starts = 1;
        options.refinement_evaluations = 0;
        const tools::TrainingData data = noisy_data(400);
        const tools::TrainedModel model = tools::train(data, options).model;
        CHECK(model.input.kind == tools::InputKind::DFR);
        CHECK(model.input.lags == 15);
        CHECK(model.sample_period_s == data.sample_period_s);
    }
}

} // namespace lag_spacing_test
