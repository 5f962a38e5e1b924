// SPDX-License-Identifier: Apache-2.0
#include "tools/training/train.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/random_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace train_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tools::InputKind;

tools::TrainingData three_joints() {
    tools::NormalSource random(dfdyn::tests::seed());
    return dfdyn::tests::arm_data(600, 3, 2, random);
}

tools::TrainingOptions quick_options(InputKind kind) {
    tools::TrainingOptions options;
    options.input = kind;
    options.lags = 5;
    options.feature_count = 30;
    options.likelihood_rows = 80;
    options.starts = 3;
    options.evaluations_per_start = 25;
    options.refinement_evaluations = 5;
    return options;
}

tools::TrainedModel trained(const tools::TrainingData& data, const tools::TrainingOptions& options,
                            const tools::ProgressCallback& progress = {}) {
    return tools::train(data, options, progress).model;
}

std::string message(const tools::TrainingData& data, const tools::TrainingOptions& options) {
    try {
        tools::train(data, options);
    } catch (const tools::InputError& error) {
        return error.what();
    }
    return "";
}

bool same(const tools::TrainedModel& a, const tools::TrainedModel& b) {
    return a.input.rows == b.input.rows && a.input.scale == b.input.scale && a.input.alpha == b.input.alpha &&
           a.input.beta == b.input.beta && a.features.omega == b.features.omega &&
           a.features.length_scale == b.features.length_scale && a.outputs.offset == b.outputs.offset &&
           a.outputs.noise_std == b.outputs.noise_std &&
           a.outputs.prior_variance == b.outputs.prior_variance && a.start.weights == b.start.weights &&
           a.start.unit_upper == b.start.unit_upper && a.start.diagonal == b.start.diagonal &&
           a.training.all_starts == b.training.all_starts;
}

/// Appends a standstill: the first `rows` rows repeat the first sample.
tools::TrainingData with_standstill(tools::TrainingData data, Index rows) {
    tools::TrainingData result = data;
    const Index total = data.positions.rows() + rows;
    result.positions = MatrixXd(total, data.positions.cols());
    result.positions << data.positions.row(0).replicate(rows, 1), data.positions;
    result.outputs = MatrixXd(total, data.outputs.cols());
    result.outputs << data.outputs.row(0).replicate(rows, 1), data.outputs;
    result.gap_before.assign(static_cast<std::size_t>(total), 0);
    return result;
}

TEST_CASE("training fills the complete model for every input") {
    const auto kind = GENERATE(from_range(dfdyn::tests::all_inputs()));
    CAPTURE(static_cast<int>(kind));
    const tools::TrainingData data = three_joints();
    const tools::TrainedModel model = trained(data, quick_options(kind));
    const std::size_t k = kind == InputKind::DF || kind == InputKind::DFW ? 6 : 3;
    CHECK(model.joints == 3);
    CHECK(model.sample_period_s == data.sample_period_s);
    CHECK(model.input.kind == kind);
    CHECK(model.input.lags == 5);
    CHECK(model.input.rows_per_joint == static_cast<int>(k));
    CHECK(model.input.rows.size() == (kind == InputKind::STD ? 0 : 6 * k));
    CHECK(model.input.scale.size() == 3 * k);
    CHECK(model.features.count == 30);
    CHECK(model.features.omega.size() == 30 * 3 * k);
    CHECK(model.outputs.names == data.output_names);
    CHECK(model.outputs.offset.size() == 2);
    CHECK(model.outputs.noise_std.size() == 2);
    CHECK(model.limits.position_rad.size() == 3);
    CHECK(model.start.weights.size() == 2 * 60);
    CHECK(model.start.diagonal.size() == 60);
    CHECK(model.start.unit_upper.size() == 60 * 59 / 2);
    CHECK(model.training.method == "ML");
    CHECK(model.training.likelihood_rows == 80);
    CHECK(model.training.all_starts.size() == 3);
    CHECK(model.training.log_likelihood ==
          *std::max_element(model.training.all_starts.begin(), model.training.all_starts.end()));
}

TEST_CASE("a trained model predicts its training data") {
    const auto kind = GENERATE(InputKind::STD, InputKind::DFR, InputKind::DFSR);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    CAPTURE(static_cast<int>(kind));
    const tools::TrainingData data = three_joints();
    tools::TrainingOptions options = quick_options(kind);
    options.feature_count = 100;
    options.likelihood_rows = 200;
    options.evaluations_per_start = 60;
    const tools::TrainedModel model = trained(data, options);
    const tools::RowList rows = dfdyn::tests::rows_between(5, 600);
    const MatrixXd features =
        tools::random_features(model.features, tools::stored_inputs(model.input, data, rows));
    for (Index output = 0; output < 2; ++output) {
        const auto k = static_cast<std::size_t>(output);
        const VectorXd weights = Eigen::Map<const VectorXd>(model.start.weights.data() + output * 200, 200);
        const VectorXd measured = data.outputs.col(output).tail(595);
        const VectorXd predicted =
            model.outputs.offset[k] + (model.outputs.noise_std[k] * features * weights).array();
        const double spread = std::sqrt((measured.array() - measured.mean()).square().mean());
        CHECK((measured - predicted).norm() / std::sqrt(595) < 0.2 * spread);
    }
}

TEST_CASE("training is deterministic for any number of threads") {
    const auto kind = GENERATE(InputKind::STD, InputKind::DFR, InputKind::DFSR);
    CAPTURE(static_cast<int>(kind));
    const tools::TrainingData data = three_joints();
    tools::TrainingOptions options = quick_options(kind);
    const tools::TrainedModel first = trained(data, options);
    CHECK(same(first, trained(data, options)));
    options.threads = 1;
    CHECK(same(first, trained(data, options)));
    options.threads = 5;
    CHECK(same(first, trained(data, options)));
    options.seed = 2;
    const tools::TrainedModel other = trained(data, options);
    CHECK(other.features.omega != first.features.omega);
}

TEST_CASE("rows at rest affect neither scales nor offsets") {
    const tools::TrainingData moving = three_joints();
    const tools::TrainingData resting = with_standstill(moving, 3000);
    const tools::TrainingOptions options = quick_options(InputKind::DF); // scales without hyperparameters
    const tools::TrainedModel a = trained(moving, options);
    const tools::TrainedModel b = trained(resting, options);
    for (std::size_t i = 0; i < a.input.scale.size(); ++i) {
        CHECK(b.input.scale[i] == Approx(a.input.scale[i]).epsilon(0.03));
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const auto output = moving.outputs.col(static_cast<Index>(k));
        const double range = output.maxCoeff() - output.minCoeff();
        // After the standstill five more rows in motion have a complete window.
        CHECK(std::abs(b.outputs.offset[k] - a.outputs.offset[k]) < 5 * range / 595);
    }
}

TEST_CASE("uncentred outputs have offset 0 and centring equals subtracting the mean first") {
    const auto hyper = GENERATE(tools::HyperMethod::ML, tools::HyperMethod::CV);
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::TrainingData data = three_joints();
    tools::TrainingOptions options = quick_options(InputKind::DFSR);
    options.hyper = hyper;
    const tools::TrainedModel centred = trained(data, options);
    CHECK(std::abs(centred.outputs.offset[0]) > 0.1);
    options.centred = false;
    const tools::TrainedModel as_it_is = trained(data, options);
    CHECK(as_it_is.outputs.offset == std::vector<double>{0, 0});
    for (Index k = 0; k < 2; ++k) {
        data.outputs.col(k).array() -= centred.outputs.offset[static_cast<std::size_t>(k)];
    }
    const tools::TrainedModel before = trained(data, options);
    CHECK(before.training.log_likelihood == Approx(centred.training.log_likelihood).epsilon(1e-6));
}

TEST_CASE("STD without relevance scales every input to unit deviation") {
    tools::TrainingOptions options = quick_options(InputKind::STD);
    options.relevance = false;
    const tools::TrainingData data = three_joints();
    const tools::TrainedModel model = trained(data, options);
    for (Index joint = 0; joint < 3; ++joint) { // all rows are in motion; the first five have no window
        const auto deviation = [](const VectorXd& x) {
            return std::sqrt((x.array() - x.mean()).square().mean());
        };
        const auto at = static_cast<std::size_t>(3 * joint);
        CHECK(model.input.scale[at] * deviation(data.positions.col(joint).tail(595)) == Approx(1));
        CHECK(model.input.scale[at + 1] * deviation(data.velocities.col(joint).tail(595)) == Approx(1));
        CHECK(model.input.scale[at + 2] * deviation(data.accelerations.col(joint).tail(595)) == Approx(1));
    }
    options.relevance = true;
    CHECK(trained(data, options).training.log_likelihood >= model.training.log_likelihood);
}

TEST_CASE("limits are ten times the largest training value and at least two pi for positions") {
    tools::TrainingData data = three_joints();
    data.positions.col(1) *= 0.01;
    const tools::TrainedModel model = trained(data, quick_options(InputKind::DFSR));
    CHECK(model.limits.position_rad[0] == 10 * data.positions.col(0).cwiseAbs().maxCoeff());
    CHECK(model.limits.position_rad[1] == 2 * std::numbers::pi);
    CHECK(model.limits.output[1] == 10 * data.outputs.col(1).cwiseAbs().maxCoeff());
}

TEST_CASE("training reports every evaluation and every start") {
    const tools::TrainingOptions options = quick_options(InputKind::DFSR);
    int calls = 0;
    int after_the_starts = 0;
    std::size_t ended = 0;
    std::vector<double> ends(3);
    tools::TrainingProgress last;
    int starting_calls = 0;
    const auto model = trained(three_joints(), options, [&](const tools::TrainingProgress& progress) {
        if (!progress.searching) {
            ++starting_calls;
            return;
        }
        ++calls;
        last = progress;
        after_the_starts += ended == 3 ? 1 : 0;
        if (progress.end) {
            ends.at(static_cast<std::size_t>(progress.end->start)) = progress.end->log_likelihood.value();
            ++ended;
        }
    });
    CHECK(calls == last.evaluations + 3);
    CHECK(last.evaluations <= last.evaluations_most);
    CHECK(last.evaluations_most == 80); // three starts and the refinement
    CHECK(after_the_starts > 0);
    CHECK(ends == model.training.all_starts);
    CHECK(starting_calls == 1); // followed by the start of learning
}

TEST_CASE("cross validation reports every point of its grid") {
    tools::TrainingOptions options = quick_options(InputKind::DF);
    options.hyper = tools::HyperMethod::CV;
    int calls = 0;
    trained(three_joints(), options, [&](const tools::TrainingProgress& progress) {
        if (!progress.searching) {
            return;
        }
        CHECK(progress.evaluations == ++calls);
        CHECK(progress.evaluations_most == 169);
        CHECK_FALSE(progress.end);
    });
    CHECK(calls == 169);
}

TEST_CASE("an exception of the callback ends training") {
    const auto callback = [](const tools::TrainingProgress&) { throw std::domain_error("enough"); };
    CHECK_THROWS_AS(tools::train(three_joints(), quick_options(InputKind::DFR), callback), std::domain_error);
}

TEST_CASE("training rejects data from which it cannot learn") {
    tools::TrainingData data = three_joints();
    const tools::TrainingOptions options = quick_options(InputKind::DFR);
    SECTION("an arm at rest") {
        data.positions.rowwise() = data.positions.row(0).eval();
        CHECK(message(data, options) ==
              "training data: expected at least 20 rows in motion with 5 rows before "
              "them without a gap, found 0");
    }
    SECTION("gaps everywhere") {
        for (std::size_t row = 0; row < data.gap_before.size(); row += 5) {
            data.gap_before[row] = 1;
        }
        CHECK(message(data, options) ==
              "training data: expected at least 20 rows in motion with 5 rows before "
              "them without a gap, found 0; the time steps are not constant: 119 gaps at a sample "
              "period of 10 ms, at most 5 rows without one");
    }
    SECTION("a constant output") {
        data.outputs.col(1).setConstant(2.5);
        CHECK(
            message(data, options) ==
            "training data: expected outputs that vary, found tau2 constant at 2.5 over the rows in motion");
    }
    SECTION("a value that is not a number") {
        data.positions(2, 0) = std::nan("");
        CHECK(message(data, options) ==
              "training data: row 2, position of joint 1: expected a finite number, found nan");
    }
    SECTION("outputs beyond what doubles can square") {
        data.outputs *= 1e200;
        CHECK(message(data, options) ==
              "training: expected a finite likelihood from at least one of 3 starts, found none");
    }
}

TEST_CASE("training rejects options out of range") {
    tools::TrainingOptions options = quick_options(InputKind::DFR);
    const tools::TrainingData data = three_joints();
    SECTION("lags") {
        options.lags = 0;
        CHECK(message(data, options) == "training options: expected at least 1 lags, found 0");
    }
    SECTION("lags of DFSR") {
        options.input = InputKind::DFSR;
        options.lags = 1;
        CHECK(message(data, options) == "training options: expected at least 2 lags, found 1");
    }
    SECTION("rows per joint") {
        options.rows_per_joint = 7;
        CHECK(message(data, options) == "training options: expected 1 to lags + 1 rows per joint, found 7");
    }
    SECTION("features") {
        options.feature_count = 0;
        CHECK(message(data, options) == "training options: expected at least 1 random feature, found 0");
    }
    SECTION("likelihood rows") {
        options.likelihood_rows = 19;
        CHECK(message(data, options) == "training options: expected at least 20 likelihood rows, found 19");
    }
    SECTION("starts") {
        options.starts = 0;
        CHECK(message(data, options) == "training options: expected at least 1 start, found 0");
    }
    SECTION("evaluations") {
        options.evaluations_per_start = 0;
        CHECK(message(data, options) ==
              "training options: expected at least 1 evaluation per start, found 0");
    }
    SECTION("threads") {
        options.threads = 0;
        CHECK(message(data, options) == "training options: expected at least 1 thread, found 0");
    }
    SECTION("refinement") {
        options.refinement_evaluations = -1;
        CHECK(message(data, options) ==
              "training options: expected at least 0 evaluations of the refinement, found -1");
    }
    SECTION("forgetting factor") {
        options.forgetting_factor = GENERATE(1.01, 0.98);
        CHECK(message(data, options) ==
              "training options: expected a forgetting factor from 1 - 1/(2 features) "
              "= 0.983333 to 1, found " +
                  tools::number_text(options.forgetting_factor));
        options.forgetting_factor = 0.98;
        options.model = &tools::structure("P"); // it has no features
        CHECK_THAT(message(data, options), !Catch::Matchers::ContainsSubstring("forgetting"));
    }
}

} // namespace train_test
