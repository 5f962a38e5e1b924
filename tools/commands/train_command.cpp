// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/options.hpp"
#include "tools/common/atomic_file.hpp"
#include "tools/common/error.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/text.hpp"
#include "tools/evaluation/contradiction.hpp"
#include "tools/model/model_file.hpp"
#include "tools/model/model_header.hpp"
#include "tools/training/recorded_data.hpp"
#include "tools/training/train.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct TrainOptions {
    RecordingOptions recordings;
    std::string outputs;
    std::string structure = "NP";
    std::string input = "DFR";
    std::string hyper = "ML";
    std::filesystem::path model;
    std::filesystem::path header;
    TrainingOptions training;
};

void add_training_options(CLI::App& command, TrainingOptions& training) {
    command.add_option("--lags", training.lags, "M: the window holds M+1 positions per joint")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_option("--features-per-joint", training.rows_per_joint, "k: rows of R (DFR)")
        ->check(CLI::Range(1, 1001))
        ->capture_default_str();
    command.add_option("--features", training.feature_count, "d random features: 2d columns")
        ->check(CLI::Range(1, 5000))
        ->capture_default_str();
    command.add_flag("--orthogonal,!--independent", training.orthogonal,
                     "Orthogonal (default) or independent random features");
    command
        .add_option("--forgetting", training.forgetting_factor, "Forgetting factor of the learner; 1: none")
        ->capture_default_str();
    command.add_option("--likelihood-rows", training.likelihood_rows, "Samples in the exact kernel, at most")
        ->check(CLI::Range(20, 20000))
        ->capture_default_str();
    command
        .add_option("--refinement", training.refinement_evaluations,
                    "Evaluations, at most, of the likelihood of the random features on all rows; 0: exact "
                    "kernel only")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    command.add_option("--starts", training.starts, "Local searches from different starts")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_option("--seed", training.seed, "Of the starts and of the random features")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
}

std::string file_names(const std::vector<Recording>& recordings, TrainingRecord& record) {
    for (const Recording& recording : recordings) {
        record.recordings.push_back(std::filesystem::path(recording.source).filename().string());
    }
    return listed(record.recordings);
}

TrainedModel train_with_progress(const TrainingData& data, const TrainingOptions& options) {
    std::unique_ptr<Progress> line;
    return train(data, options,
                 [&line](const TrainingProgress& progress) {
                     if (line == nullptr) {
                         line =
                             std::make_unique<Progress>("maximising the marginal likelihood",
                                                        static_cast<std::size_t>(progress.evaluations_most));
                     }
                     line->update(static_cast<std::size_t>(progress.evaluations));
                 })
        .model;
}

void print_outcome(const TrainedModel& model, const std::string& trained_on) {
    std::cout << "trained " << model.structure << " with input " << to_string(model.input.kind) << " on "
              << trained_on << ", rows " << model.training.rows << " (" << model.training.likelihood_rows
              << " in the exact kernel)\nlog likelihood per start:";
    for (const double value : model.training.all_starts) {
        std::cout << ' ' << value;
    }
    std::cout << "\nlength scale " << model.features.length_scale << ", rho^2/sigma^2 "
              << model.outputs.prior_variance << ", noise";
    for (std::size_t k = 0; k < model.outputs.names.size(); ++k) {
        std::cout << ' ' << model.outputs.names[k] << ' ' << model.outputs.noise_std[k];
    }
    std::cout << '\n';
}

int run(const TrainOptions& options) {
    check_distinct({options.model, options.header}, options.recordings.logs);
    const OutputKind outputs = parse_output_kind(options.outputs);
    TrainingOptions training = options.training;
    training.input = parse_input_kind(options.input);
    const std::vector<Recording> recordings = options.recordings.read(0, outputs);
    TrainingData data = gather_training_data(recordings);
    if (training.input == InputKind::STD) {
        training.position_noise_bound = estimate_position_noise_bound(data);
        estimate_derivatives(data, recordings, training.lags, training.position_noise_bound);
    }
    TrainedModel model = train_with_progress(data, training);
    const std::string trained_on = file_names(recordings, model.training);
    model.training.rows = options.recordings.rows;
    calibrate_innovation_limit(model, recordings);
    const std::string json = model_to_json(model);
    model_from_json(json, shown(options.model)); // nothing is written that `replay` would refuse
    write_file(options.model, json);
    if (!options.header.empty()) {
        write_file(options.header, model_to_header(model, to_identifier(options.header.stem().string())));
    }
    print_outcome(model, trained_on);
    return 0;
}

} // namespace

void add_train_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<TrainOptions>();
    CLI::App* command =
        app.add_subcommand("train", "Fits hyperparameters and the start of learning to recordings");
    options->recordings.add_to(*command);
    command
        ->add_option("--outputs", options->outputs,
                     "What to predict: tau (torques), i (motor currents), wrench")
        ->required()
        ->type_name("tau|i|wrench");
    command->add_option("--model", options->structure, "Structure of the model")
        ->check(CLI::IsMember({"NP"}))
        ->capture_default_str();
    command->add_option("--input", options->input, "What the features see of the positions")
        ->type_name("STD|DF|DFW|DFR|DFSR")
        ->capture_default_str();
    command->add_option("--hyper", options->hyper, "How hyperparameters are found: ML, marginal likelihood")
        ->check(CLI::IsMember({"ML"}))
        ->capture_default_str();
    command->add_option("-o,--output", options->model, "The model")->required()->type_name("M.json");
    command->add_option("--header", options->header, "The same model as C++ constants for flash")
        ->type_name("M.hpp");
    add_training_options(*command, options->training);
    command->footer(
        "Example:\n  dfdyn train --log run.csv --rows :3400 --outputs i --input DFR -o model.json\n"
        "Exit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
