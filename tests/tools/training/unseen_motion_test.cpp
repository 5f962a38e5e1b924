// SPDX-License-Identifier: Apache-2.0
// Predictions of a real arm's motion by models that were not trained on it.
#include "tools/training/model_training.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/model/structure.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

namespace unseen_motion_test {

using namespace dfdyn::tools;
using Eigen::VectorXd;

Recording recording(const std::string& name, RowRange rows = {}) {
    ReadOptions options;
    options.outputs = OutputKind::motor_current;
    options.rows = rows;
    return read_recording(std::filesystem::path(DFDYN_TEST_DATA_DIR) / "ur5_kufieta" / name, options);
}

/// Result per output.
struct Outcome {
    VectorXd error;    ///< rms relative to the deviation from the mean of the training recording
    VectorXd coverage; ///< share of samples within two standard deviations
};

/// Returns the result over `unseen`, with `budget` for each tick.
Outcome replayed(std::span<const TrainedModel> models, const Recording& learned, const Recording& unseen,
                 dfdyn::Budget budget) {
    const auto estimator = make_estimator(models, false);
    const std::size_t outputs = unseen.output.names.size();
    VectorXd mean = VectorXd::Zero(static_cast<Eigen::Index>(outputs));
    for (std::size_t row = 0; row < learned.row_count(); ++row) {
        for (std::size_t k = 0; k < outputs; ++k) {
            mean[static_cast<Eigen::Index>(k)] +=
                learned.output.row(row)[k] / static_cast<double>(learned.row_count());
        }
    }
    Outcome outcome{VectorXd::Zero(mean.size()), VectorXd::Zero(mean.size())};
    VectorXd constant = VectorXd::Zero(mean.size());
    double predicted = 0;
    for (std::size_t row = 0; row < unseen.row_count(); ++row) {
        const auto measured_output =
            budget.operations > 0 ? unseen.output.row(row) : std::span<const double>();
        const Tick tick =
            estimator->tick({unseen.time_ns[row], unseen.position.row(row), {}, {}, measured_output}, budget);
        if (!tick.status.estimated()) { // predictions beyond the bound count, as bounded
            continue;
        }
        ++predicted;
        for (std::size_t k = 0; k < outputs; ++k) {
            const auto output = static_cast<Eigen::Index>(k);
            const double measured = unseen.output.row(row)[k];
            const double error = measured - static_cast<double>(tick.prediction[k]);
            outcome.error[output] += error * error;
            outcome.coverage[output] +=
                std::abs(error) <= 2 * static_cast<double>(tick.standard_deviation[k]) ? 1 : 0;
            constant[output] += (measured - mean[output]) * (measured - mean[output]);
        }
    }
    REQUIRE(predicted > 1000);
    outcome.error = outcome.error.cwiseQuotient(constant).cwiseSqrt();
    outcome.coverage /= predicted;
    return outcome;
}

Outcome frozen(std::span<const TrainedModel> models, const Recording& learned, const Recording& unseen) {
    return replayed(models, learned, unseen, dfdyn::Budget::predict_only());
}

RobotPhysics physics() {
    return {dfdyn::tests::ur5(), {"viscous_friction", "coulomb_friction", "torque_offset"}, 0.05, {}};
}

TrainedModel trained(const Recording& learned, const ModelTraining& training) {
    return train_model(prepare_training(std::span(&learned, 1), training), OutputKind::motor_current,
                       training, {})
        .model;
}

// This pair of recordings was already known when the range in Extrapolation::parameter_doubt was chosen.
TEST_CASE("P predicts a motion of a real arm outside its training data within its deviation", "[.long]") {
    const Recording learned = recording("Movement_No5_Acc_slow_no_disturbance.csv");
    const Recording unseen = recording("Movement_No9_Singularity_Free_NoDist.csv");
    ModelTraining training;
    training.options.model = &structures::P;
    training.options.likelihood_rows = 500;
    training.options.starts = 2;
    training.physics = physics();
    const Outcome calibrated = frozen(std::vector{trained(learned, training)}, learned, unseen);
    for (Eigen::Index k = 0; k < calibrated.error.size(); ++k) {
        CAPTURE(k, calibrated.error[k], calibrated.coverage[k]);
        CHECK(calibrated.error[k] < 1.2);
        CHECK(calibrated.coverage[k] > 0.9);
    }
    training.options.shrinkage = false;
    const Outcome paper = frozen(std::vector{trained(learned, training)}, learned, unseen);
    CHECK(paper.error.minCoeff() > 1.5);
    CHECK(paper.coverage.maxCoeff() < 0.9);
}

/// NP, P and SPK with few rows and starts, for time.
std::vector<TrainedModel> three_models(const Recording& learned) {
    std::vector<TrainedModel> models;
    for (const Structure* const structure : {&structures::NP, &structures::P, &structures::SPK}) {
        ModelTraining training;
        training.options.model = structure;
        training.options.likelihood_rows = 300;
        training.options.starts = 2;
        training.options.refinement_evaluations = 20;
        if (structure != &structures::NP) {
            training.physics = physics();
        }
        models.push_back(trained(learned, training));
    }
    return models;
}

/// Checks that no output's error of the models' combination exceeds the best model's by more than 5 %.
void check_combination(std::span<const TrainedModel> models, const Recording& learned,
                       const Recording& unseen, dfdyn::Budget budget) {
    const VectorXd combined = replayed(models, learned, unseen, budget).error;
    VectorXd best = VectorXd::Constant(combined.size(), std::numeric_limits<double>::infinity());
    for (const TrainedModel& model : models) {
        best = best.cwiseMin(replayed({&model, 1}, learned, unseen, budget).error);
    }
    for (Eigen::Index k = 0; k < best.size(); ++k) {
        CAPTURE(k, combined[k], best[k]);
        CHECK(combined[k] <= 1.05 * best[k]);
    }
}

// These rows are among the data that chose the weight of the variances.
TEST_CASE("a frozen combination is at most 5 % worse than its best member later in the training motion",
          "[.long]") {
    const std::string name = "Movement_No5_Acc_slow_no_disturbance.csv";
    const Recording learned = recording(name, {0, 2200});
    check_combination(three_models(learned), learned, recording(name, {2200}), dfdyn::Budget::predict_only());
}

// No9 did not choose the weights.
TEST_CASE("a combination that learns another motion is at most 5 % worse than its best member", "[.long]") {
    const Recording learned = recording("Movement_No6_Acc_slow_Verify_Model.csv", {0, 4000});
    check_combination(three_models(learned), learned, recording("Movement_No9_Singularity_Free_NoDist.csv"),
                      dfdyn::Budget::unlimited());
}

} // namespace unseen_motion_test
