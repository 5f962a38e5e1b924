// SPDX-License-Identifier: Apache-2.0
// A model of one run, applied to other undisturbed runs of the same real arm, rejects no good sample.
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay.hpp"
#include "tools/training/model_training.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

namespace good_samples_test {

using namespace dfdyn::tools;

Recording recording(const std::string& file, OutputKind outputs = OutputKind::motor_current,
                    RowRange rows = {}) {
    ReadOptions options;
    options.outputs = outputs;
    options.rows = rows;
    return read_recording(std::filesystem::path(DFDYN_TEST_DATA_DIR) / file, options);
}

TrainedModel trained_on(Recording motion, OutputKind outputs, const ModelTraining& training) {
    const std::vector<Recording> recordings{std::move(motion)};
    TrainedModel model = train_model(prepare_training(recordings, training), outputs, training, {}).model;
    calibrate_innovation_limit(model, recordings);
    return model;
}

TrainedModel trained_on(const std::string& file) {
    ModelTraining training;
    training.options.feature_count = 50;
    training.options.likelihood_rows = 300;
    training.options.starts = 1;
    return trained_on(recording(file), OutputKind::motor_current, training);
}

struct Outcome {
    double refused_share = 0, learned_share = 0;
    std::size_t contradictions = 0;
};

Outcome replayed(const TrainedModel& model, const Recording& motion) {
    const auto estimator = make_estimator(model, false);
    const ReplayedRecording result = replay(*estimator, std::span(&model, 1), motion, 0, [](std::size_t) {});
    const auto refused = std::ranges::count_if(result.status, [](const dfdyn::Status& status) {
        return status.learning == dfdyn::Reason::innovation_too_large;
    });
    const auto learned =
        std::ranges::count_if(result.status, [](const dfdyn::Status& status) { return status.learned(); });
    const auto rows = static_cast<double>(result.status.size());
    return {static_cast<double>(refused) / rows, static_cast<double>(learned) / rows,
            find_contradictions(result, model.limits.innovation).size()};
}

TEST_CASE("a UR5 rejects no good sample of another motion but reports a person's pushes") {
    const TrainedModel model = trained_on("ur5_kufieta/Movement_No6_Acc_slow_Verify_Model.csv");
    for (const char* motion : {"No7_Acc_slow_Verify_Model_short", "No9_Singularity_Free_NoDist"}) {
        CAPTURE(motion);
        const Outcome outcome =
            replayed(model, recording(std::string("ur5_kufieta/Movement_") + motion + ".csv"));
        CHECK(outcome.refused_share < 0.001);
        CHECK(outcome.learned_share > 0.95);
    }
    const Outcome pushed = replayed(
        model, recording("ur5_kufieta/Movement_No7_Acc_slow_Verify_Model_short_with_disturbance.csv"));
    CHECK(pushed.contradictions >= 3); // of five pushes
}

TEST_CASE("a servo rejects no good sample at other gains and along other motions") {
    const TrainedModel model = trained_on("xl330_bam/00_sin_sin_kp100.csv");
    for (const char* run : {"04_sin_sin_kp200", "08_sin_sin_kp400", "12_sin_sin_kp800",
                            "14_up_and_down_kp800", "15_sin_time_square_kp800"}) {
        CAPTURE(run);
        const Outcome outcome = replayed(model, recording(std::string("xl330_bam/") + run + ".csv"));
        CHECK(outcome.refused_share < 0.001);
        CHECK(outcome.learned_share > 0.95);
    }
}

TEST_CASE("a model of two seconds of motion rejects no good sample of the next second") {
    constexpr OutputKind outputs = OutputKind::joint_torque;
    const std::string file = "tx40_figaroh/tx40_5kHz.csv";
    ModelTraining training;
    training.options.lags = 20;
    training.options.every = 10;
    training.options.feature_count = 63;
    training.options.likelihood_rows = 200;
    training.options.starts = 1;
    training.options.refinement_evaluations = 0;
    const TrainedModel model =
        trained_on(recording(file, outputs, {.first = 0, .last = 10'500}), outputs, training);
    const Outcome outcome = replayed(model, recording(file, outputs, {.first = 10'500, .last = 15'000}));
    CHECK(outcome.refused_share == 0);
    CHECK(outcome.learned_share > 0.95);
}

} // namespace good_samples_test
