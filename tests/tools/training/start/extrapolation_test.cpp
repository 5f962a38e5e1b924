// SPDX-License-Identifier: Apache-2.0
// Training measures the deviation of the outputs away from its data; these tests measure the estimator's
// predictions.
#include "tools/training/start/extrapolation.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/training/arm_data.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/training/train.hpp"

#include <cmath>
#include <vector>

namespace extrapolation_training_test {

namespace tools = dfdyn::tools;
using Eigen::Index;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// Error relative to the outputs' mean in the training data, and coverage, per output.
struct Outcome {
    VectorXd error;    ///< rms relative to the constant prediction's
    VectorXd coverage; ///< share of samples within two standard deviations
};

Outcome frozen(const tools::TrainedModel& model, const tools::TrainingData& data, const RowVectorXd& mean) {
    const auto estimator = tools::make_estimator(model, false);
    const Index m = data.outputs.cols();
    Outcome outcome{VectorXd::Zero(m), VectorXd::Zero(m)};
    VectorXd constant = VectorXd::Zero(m);
    double predicted = 0;
    for (Index t = 0; t < data.positions.rows(); ++t) {
        const VectorXd position = data.positions.row(t).transpose();
        const tools::Tick tick =
            estimator->tick({t * std::llround(1e9 * data.sample_period_s),
                             {position.data(), static_cast<std::size_t>(position.size())},
                             {},
                             {},
                             {}},
                            dfdyn::Budget::predict_only());
        if (!tick.status.predicted()) {
            continue;
        }
        ++predicted;
        for (Index k = 0; k < m; ++k) {
            const auto output = static_cast<std::size_t>(k);
            const double error = data.outputs(t, k) - static_cast<double>(tick.prediction[output]);
            outcome.error[k] += error * error;
            outcome.coverage[k] +=
                std::abs(error) <= 2 * static_cast<double>(tick.standard_deviation[output]) ? 1 : 0;
            constant[k] += std::pow(data.outputs(t, k) - mean[k], 2);
        }
    }
    REQUIRE(predicted > 100);
    outcome.error = outcome.error.cwiseQuotient(constant).cwiseSqrt();
    outcome.coverage /= predicted;
    return outcome;
}

tools::TrainingOptions options() {
    tools::TrainingOptions result;
    result.input = tools::InputKind::DFSR;
    result.lags = 5;
    result.feature_count = 60;
    result.likelihood_rows = 150;
    result.starts = 2;
    result.evaluations_per_start = 40;
    result.refinement_evaluations = 5;
    return result;
}

tools::TrainingData small_arm() {
    tools::NormalSource random(dfdyn::tests::seed());
    return dfdyn::tests::arm_data(1000, 2, 2, random);
}

/// The same motion and outputs with each joint's position moved by eight length scales.
tools::TrainingData elsewhere(tools::TrainingData data, const tools::TrainedModel& model) {
    const auto rows = static_cast<std::size_t>(model.input.rows_per_joint);
    for (std::size_t joint = 0; joint < static_cast<std::size_t>(model.joints); ++joint) {
        data.positions.col(static_cast<Index>(joint)).array() +=
            8 * model.features.length_scale / model.input.scale[joint * rows];
    }
    return data;
}

TEST_CASE(
    "far from its data a model of features is about as accurate as the mean and its deviation covers that") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const tools::TrainingData here = small_arm();
    tools::TrainedModel model = tools::train(here, options()).model;
    const tools::TrainingData there = elsewhere(here, model);
    model.limits.position_rad.assign(2, 2 * there.positions.cwiseAbs().maxCoeff());
    const RowVectorXd mean = here.outputs.colwise().mean();
    REQUIRE(model.extrapolation.has_value());
    const Outcome near = frozen(model, here, mean);
    const Outcome far = frozen(model, there, mean);
    for (Index k = 0; k < 2; ++k) {
        CAPTURE(k);
        CHECK(near.error[k] < 0.3);
        CHECK(near.coverage[k] > 0.9);
        CHECK(far.error[k] < 1.05);
        CHECK(far.coverage[k] > 0.9);
    }
    model.extrapolation.reset(); // the estimator of the paper
    const Outcome paper = frozen(model, there, mean);
    CHECK(paper.error.maxCoeff() > far.error.maxCoeff() + 0.05);
}

TEST_CASE("an output that is zero in nearly all rows has the range of its largest value") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    tools::TrainingData data = small_arm();
    data.outputs.col(0).head(995).setZero(); // closed brakes
    data.outputs.col(0).tail(5).setConstant(-6);
    tools::TrainedModel model;
    model.outputs.offset = {0, 0};
    model.outputs.noise_std = {2, 1};
    const std::vector<double> variances =
        tools::output_variances(model, data, dfdyn::tests::rows_between(0, 1000));
    CHECK(variances[0] == Approx(3 * 3 / 3.0));
    const double largest = data.outputs.col(1).cwiseAbs().maxCoeff();
    CHECK(variances[1] > 0);
    CHECK(variances[1] < largest * largest / 3);
}

TEST_CASE("without shrinkage training gives the model of the paper") {
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());
    const tools::TrainingData data = small_arm();
    tools::TrainingOptions paper = options();
    paper.shrinkage = false;
    const tools::TrainedModel without = tools::train(data, paper).model;
    const tools::TrainedModel with = tools::train(data, options()).model;
    CHECK_FALSE(without.extrapolation.has_value());
    CHECK(without.start.weights == with.start.weights);
    CHECK(without.outputs.noise_std == with.outputs.noise_std);
}

} // namespace extrapolation_training_test
