// SPDX-License-Identifier: Apache-2.0
// Every model × input × tuning of the paper: trained, run by the embedded estimator in float, and compared
// with the solution of its regression over all samples so far at once, in double.
#include "tests/acceptance/dense_solution.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/host/host_estimator.hpp"
#include "tools/physics/model_training.hpp"
#include "tools/robot/read_robot.hpp"
#include "tools/simulation/simulation_csv.hpp"
#include "tools/training/recorded_data.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::DenseRegression;
using dfdyn::tests::DenseSolution;
using Eigen::Index;

constexpr std::size_t training_rows = 250;
constexpr std::size_t online_rows = 200;
constexpr std::size_t held_out_rows = 30; ///< after each checkpoint

Robot small_arm() {
    ReadRobotOptions options;
    options.tip = "tool";
    return read_robot(DFDYN_TEST_DATA_DIR "/robots/small_arm/small_arm.urdf", options);
}

/// What the sensors of the small arm show in a few seconds of motion.
class SimulatedRecording {
  public:
    explicit SimulatedRecording(const Robot& robot) {
        const Scenario scenario = read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json", robot);
        std::ofstream file(path());
        SimulatedRecordingCsv csv(file, scenario, robot.joints.size());
        Simulation simulation(robot, scenario);
        for (std::size_t row = 0; row < scenario.recording.samples; ++row) {
            csv.write(simulation.next());
        }
    }

    Recording rows(OutputKind outputs, std::size_t first, std::size_t last) const {
        ReadOptions options;
        options.outputs = outputs;
        options.velocity = options.acceleration = true;
        options.rows = {first, last};
        return read_recording(path(), options);
    }

  private:
    std::filesystem::path path() const { return directory_.path() / "run.csv"; }

    dfdyn::tests::TemporaryDirectory directory_;
};

struct Combination {
    ModelClass model;
    InputKind input;
    DerivativeSource derivatives;
    HyperMethod hyper;
};

std::string name(const Combination& one) {
    const char* const inputs[] = {"STD", "DF", "DFW", "DFR", "DFSR"};
    const char* const models[] = {"NP", "P", "SP", "SP2", "SPK"};
    return std::string(models[static_cast<int>(one.model)]) + " " + inputs[static_cast<int>(one.input)] +
           (one.input == InputKind::STD && one.derivatives == DerivativeSource::measured ? " (measured)"
                                                                                         : "") +
           (one.hyper == HyperMethod::ML ? " ML" : " CV");
}

/// CV exists for NP, P and SP2 with STD, DF and DFSR; STD with derivatives measured and estimated.
std::vector<Combination> table() {
    std::vector<Combination> rows;
    for (const ModelClass model :
         {ModelClass::NP, ModelClass::P, ModelClass::SP, ModelClass::SP2, ModelClass::SPK}) {
        for (const InputKind input :
             {InputKind::STD, InputKind::DF, InputKind::DFW, InputKind::DFR, InputKind::DFSR}) {
            const bool cv = model != ModelClass::SP && model != ModelClass::SPK && input != InputKind::DFW &&
                            input != InputKind::DFR;
            for (const HyperMethod hyper : {HyperMethod::ML, HyperMethod::CV}) {
                if (hyper == HyperMethod::CV && !cv) {
                    continue;
                }
                rows.push_back({model, input, DerivativeSource::estimated, hyper});
                if (input == InputKind::STD) {
                    rows.push_back({model, input, DerivativeSource::measured, hyper});
                }
            }
        }
    }
    return rows;
}

ModelTraining training_of(const Combination& one, OutputKind outputs, const Robot& robot) {
    ModelTraining training;
    training.derivatives = one.derivatives;
    TrainingOptions& options = training.options;
    options.model = one.model;
    options.input = one.input;
    options.hyper = one.hyper;
    options.lags = 6;
    options.feature_count = 15;
    options.likelihood_rows = 80;
    options.starts = 1;
    options.evaluations_per_start = 30;
    options.refinement_evaluations = 0;
    options.threads = 1;
    training.physics = RobotPhysics{robot, {"ft_bias"}, 0.1, {}};
    if (outputs == OutputKind::joint_torque) {
        training.physics->effects = {"viscous_friction", "coulomb_friction", "torque_offset"};
    }
    return training;
}

/// The samples of all recordings with the derivatives that the model computes itself.
PreparedTraining prepared_for(const TrainedModel& model, const ModelTraining& training,
                              const std::vector<Recording>& recordings) {
    PreparedTraining prepared = prepare_training(recordings, training);
    if (prepared.derivatives == Derivatives::estimated) {
        const InputModel& input = model.features.count > 0 ? model.input : model.physics->motion;
        estimate_derivatives(prepared.data, recordings, training.options.lags, input.position_noise_bound);
    }
    return prepared;
}

struct Disagreement {
    double prediction = 0;         ///< largest, in deviations of the output
    double standard_deviation = 0; ///< largest, relative
    double start = 0;              ///< of restart_model()'s predictions, in deviations of the output
};

/// One row of the table: the estimator runs on from where training left it.
class Row {
  public:
    Row(const Combination& one, OutputKind outputs, const Robot& robot, const SimulatedRecording& recording)
        : recording_(recording), outputs_(outputs), training_(training_of(one, outputs, robot)),
          recordings_{recording.rows(outputs, 0, training_rows),
                      recording.rows(outputs, training_rows, training_rows + online_rows)},
          model_(trained()), data_(prepared_for(model_, training_, recordings_).data),
          regression_(model_, data_), rows_(usable()), estimator_(make_estimator(model_, false)) {}

    /// Compares after each of the `checkpoints`, numbers of online rows learned.
    Disagreement run(const std::vector<std::size_t>& checkpoints) {
        estimator_->begin_recording();
        std::optional<DenseSolution> solution;
        std::vector<float> weights(estimator_->weight_count());
        std::size_t since = held_out_rows;
        for (std::size_t online = 0; online < online_rows; ++online, ++since) {
            if (std::ranges::find(checkpoints, online) != checkpoints.end()) {
                const Index first = row_of(online);
                solution.emplace(regression_, learned_until(first));
                estimator_->copy_weights(weights);
                compare_start(online);
                since = 0;
            }
            const Tick tick = estimator_->tick(sample(online));
            check(tick, row_of(online));
            if (since == 0) {
                compare(tick.prediction, *solution, row_of(online));
                compare_deviations(tick.standard_deviation, *solution, row_of(online));
            }
            if (since < held_out_rows) {
                std::vector<float> prediction(tick.prediction.size());
                estimator_->predict_with(weights, prediction);
                compare(prediction, *solution, row_of(online));
            }
        }
        return worst_;
    }

  private:
    TrainedModel trained() const {
        TrainedModel model = train_model(prepare_training({&recordings_[0], 1}, training_), outputs_,
                                         training_, [](const TrainingProgress&) {});
        model.limits.innovation = static_cast<double>(std::numeric_limits<float>::max()); // learn everything
        return model;
    }

    RowList usable() const {
        return usable_rows(data_.gap_before,
                           std::max(model_.input.lags, model_.physics ? model_.physics->motion.lags : 0));
    }

    RowList until(Index row) const { return {rows_.begin(), std::ranges::lower_bound(rows_, row)}; }

    /// Training leaves out the first `lags` rows also where the model needs no window: measured derivatives.
    RowList learned_until(Index row) const {
        return {std::ranges::lower_bound(rows_, Index{training_.options.lags}),
                std::ranges::lower_bound(rows_, row)};
    }

    static Index row_of(std::size_t online) { return static_cast<Index>(training_rows + online); }

    MeasuredSample sample(std::size_t online) const {
        const Recording& recording = recordings_[1];
        return {recording.time_ns[online], recording.position.row(online), recording.velocity.row(online),
                recording.acceleration.row(online), recording.output.row(online)};
    }

    /// Exactly the rows with a whole window are predicted, and all of those are learned.
    void check(const Tick& tick, Index row) const {
        const bool usable = std::ranges::binary_search(rows_, row);
        if (tick.status.predicted() != usable || tick.status.learned() != usable) {
            FAIL_CHECK("tick " << row << ": " << dfdyn::name(tick.status.reason()));
        }
    }

    double deviation(Index k) const {
        const auto y = data_.outputs.col(k).array();
        return std::sqrt((y - y.mean()).square().mean());
    }
    double noise(Index k) const { return model_.outputs.noise_std[static_cast<std::size_t>(k)]; }
    double in_units(double prediction, Index k) const {
        return model_.outputs.offset[static_cast<std::size_t>(k)] + noise(k) * prediction;
    }

    void compare(std::span<const float> prediction, const DenseSolution& solution, Index row) {
        for (Index k = 0; k < regression_.outputs(); ++k) {
            const auto value = static_cast<double>(prediction[static_cast<std::size_t>(k)]);
            const double error = std::abs(value - in_units(solution.prediction(row, k), k)) / deviation(k);
            worst_.prediction = std::max(worst_.prediction, error);
        }
    }

    void compare_deviations(std::span<const float> deviations, const DenseSolution& solution, Index row) {
        for (Index k = 0; k < regression_.outputs(); ++k) {
            const auto value = static_cast<double>(deviations[static_cast<std::size_t>(k)]);
            const double truth = noise(k) * solution.standard_deviation(row, k);
            worst_.standard_deviation = std::max(worst_.standard_deviation, std::abs(value / truth - 1));
        }
    }

    /// The start that training would compute over the same rows.
    void compare_start(std::size_t online) {
        const DenseSolution solution(regression_, until(row_of(online)));
        TrainedModel restarted = model_;
        restart_model(restarted, prepared_for(model_, training_,
                                              {recordings_[0], recording_.rows(outputs_, training_rows,
                                                                               training_rows + online)}));
        for (Index row = row_of(online); row < row_of(online + held_out_rows); ++row) {
            for (Index k = 0; k < regression_.outputs(); ++k) {
                const double error =
                    regression_.predicted_by_start(restarted, row, k) - solution.prediction(row, k);
                worst_.start = std::max(worst_.start, std::abs(error) * noise(k) / deviation(k));
            }
        }
    }

    const SimulatedRecording& recording_;
    OutputKind outputs_;
    ModelTraining training_;
    std::vector<Recording> recordings_; ///< to train on, to run over
    TrainedModel model_;
    TrainingData data_;
    DenseRegression regression_;
    RowList rows_;
    std::unique_ptr<HostEstimator> estimator_;
    Disagreement worst_;
};

/// What float can keep. The worst are NP with DF and DFW, whose likelihood here grows up to the largest rho^2
/// / sigma^2 there is, 1e6: weights 1e3 times the noise meet features that float knows to 1e-7. Next is
/// physics on accelerations from differences of positions at 100 Hz: 4e-5. All others stay below 2e-5.
constexpr double prediction_tolerance = 5e-4;
constexpr double deviation_tolerance = 2e-5;
constexpr double start_tolerance = 1e-8;

void check_table(OutputKind outputs) {
    const Robot robot = small_arm();
    const SimulatedRecording recording(robot);
    for (const Combination& one : table()) {
        CAPTURE(name(one));
        const Disagreement worst = Row(one, outputs, robot, recording).run({60, online_rows - held_out_rows});
        CHECK(worst.prediction < prediction_tolerance);
        CHECK(worst.standard_deviation < deviation_tolerance);
        CHECK(worst.start < start_tolerance);
    }
}

} // namespace

TEST_CASE("every model, input and tuning predicts joint torques as the batch solution does") {
    check_table(OutputKind::joint_torque);
}

TEST_CASE("every model, input and tuning predicts a wrench as the batch solution does") {
    check_table(OutputKind::wrench);
}
