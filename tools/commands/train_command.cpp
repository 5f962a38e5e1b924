// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/system/file_set.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/clock_options.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/model_files.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/setup_options.hpp"
#include "tools/commands/options/size_options.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/commands/train_outcome.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contacts/contact_limits.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/opponents/rigid_body.hpp"
#include "tools/training/model_training.hpp"
#include "tools/training/sign_velocity.hpp"
#include "tools/training/training_options.hpp"

#include <initializer_list>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

namespace dfdyn::tools {

namespace {

struct TrainOptions {
    const CLI::App* command = nullptr; ///< the command whose options these are
    RecordingOptions recordings;
    RobotOptions robot;
    std::string outputs;
    std::string structure = structures::NP.name;
    std::string input = dfr_input().name;
    std::string hyper = "ML";
    std::filesystem::path model;
    std::filesystem::path header;
    std::string derivatives = "auto";
    std::string prior = "scaled";
    std::vector<std::string> effects;
    std::optional<double> sign_velocity;
    bool own_motion = true;
    std::vector<double> torque_constants;
    ClockOptions clock;
    SizeOptions sizes;
    SetupOptions setup;
    bool json = false;
    TrainingOptions training;
};

const std::map<std::string, DerivativeSource> sources{{"auto", DerivativeSource::automatic},
                                                      {"measured", DerivativeSource::measured},
                                                      {"estimated", DerivativeSource::estimated}};

void add_physics_options(CLI::App& command, TrainOptions& options) {
    options.robot.add_to(command, false);
    command
        .add_option("--effects", options.effects,
                    "Named effects that the physics learns in addition to the rigid body, any of " +
                        trainable_effect_names())
        ->delimiter(',')
        ->check(one_of(words_of(trainable_effect_names())))
        ->type_name("NAME[,NAME...]");
    command
        .add_option(
            "--sign-velocity", options.sign_velocity,
            "Coulomb friction is tanh(qd / this); at this velocity (rad/s) it has three quarters of "
            "its level; default: the most likely of 0.002 to 0.1; 0.05 with --shared-motion, --hyper CV or "
            "input STD")
        ->check(positive_number());
    command
        .add_option("--torque-constants", options.torque_constants,
                    "N m/A at each joint, for --outputs i; default: estimated with the nominal robot")
        ->delimiter(',')
        ->check(positive_number())
        ->type_name("K1,K2...");
    command.add_flag("--own-motion,!--shared-motion", options.own_motion,
                     "Inputs of positions: the physics computes velocity and acceleration with rows of its "
                     "own, which keep the scale of every motion (default), or, as in the paper, with those "
                     "of the features");
    command
        .add_option("--prior", options.prior,
                    "Prior of the physical parameters: gamma^2 is equal for columns of equal size (scaled), "
                    "or for all parameters (unit, as in the paper); or one variance each (diagonal)")
        ->check(one_of({"scaled", "unit", "diagonal"}))
        ->capture_default_str();
}

void add_training_options(CLI::App& command, TrainingOptions& training) {
    command.add_option("--features-per-joint", training.rows_per_joint, "k: rows of R (DFR)")
        ->check(whole_number_in(1, 1001))
        ->capture_default_str();
    command.add_option("--features", training.feature_count, "d random features: 2d columns")
        ->check(whole_number_in(1, 5000))
        ->capture_default_str();
    command.add_flag("--orthogonal,!--independent", training.orthogonal,
                     "Orthogonal (default) or independent random features");
    command.add_flag("--relevance,!--no-relevance", training.relevance,
                     "Input STD with ML: separate gains for velocity and acceleration (default), or, as in "
                     "the paper, one width for inputs of unit standard deviation");
    command.add_flag(
        "--centred,!--not-centred", training.centred,
        "Model NP: outputs minus their mean (default), or, as in the paper, a prior of mean zero");
    command.add_flag(
        "--shrinkage,!--no-shrinkage", training.shrinkage,
        "Default: physics starts near the robot's own parameters; away from the data, predictions return to "
        "the mean (NP), the physics (SP, SP2, SPK) or zero (P), and standard deviations grow to the range of "
        "the outputs. With --no-shrinkage, as in the paper, none of this");
    command.add_option("--likelihood-rows", training.likelihood_rows, "Maximum samples in the exact kernel")
        ->check(whole_number_in(20, 20000))
        ->capture_default_str();
    command
        .add_option(
            "--refinement", training.refinement_evaluations,
            "Largest number of evaluations of the likelihood of the random features on all rows; 0: exact "
            "kernel only")
        ->check(whole_number_in(0, 100000))
        ->capture_default_str();
    command.add_option("--starts", training.starts, "Local searches from different starts")
        ->check(whole_number_in(1, 1000))
        ->capture_default_str();
    command.add_option("--seed", training.seed, "Seed of the starts and of the random features")
        ->check(seed_number())
        ->capture_default_str();
}

/// Shows the progress of the hyperparameter search, from any thread, then the computation of the initial
/// state, until the callback is destroyed.
ProgressCallback progress_line(HyperMethod hyper) {
    struct Shown {
        std::unique_ptr<Progress> search;
        std::unique_ptr<Activity> start;
    };
    return [shown = std::make_shared<Shown>(), hyper](const TrainingProgress& progress) {
        if (!progress.searching) {
            shown->search.reset();
            shown->start = std::make_unique<Activity>("computing the start of learning");
            return;
        }
        if (shown->search == nullptr) {
            shown->search = std::make_unique<Progress>(
                hyper == HyperMethod::CV ? "cross validation" : "maximising the marginal likelihood",
                static_cast<std::size_t>(progress.evaluations_most));
        }
        shown->search->update(static_cast<std::size_t>(progress.evaluations));
    };
}

ModelTraining model_training(const TrainOptions& options, OutputKind outputs) {
    ModelTraining training{options.training, std::nullopt, sources.at(options.derivatives)};
    training.options.input = parse_input_kind(options.input);
    training.options.model = &structure(options.structure);
    training.options.hyper = parse_hyper_method(options.hyper);
    training.options.physics.prior = parse_prior_form(options.prior);
    training.options.physics.motion = options.own_motion ? PhysicsMotion::free : PhysicsMotion::of_input;
    if (training.options.model->has_physics()) {
        if (options.robot.urdf.empty()) {
            throw InputError("--model " + options.structure + ": expected --robot and --tip, found none");
        }
        training.physics = {options.robot.read(outputs), options.effects, options.sign_velocity,
                            options.torque_constants};
    }
    return training;
}

/// Reports given options that have no influence here.
void note_ignored(const TrainOptions& options) {
    const std::string model = "model " + options.structure;
    const Structure& structure = tools::structure(options.structure);
    const bool physics = structure.has_physics();
    const bool derivatives = input_description(parse_input_kind(options.input)).uses_derivatives();
    const bool cross_validation = options.hyper == "CV";
    const auto note = [&](bool ignored, std::initializer_list<const char*> names, const std::string& by) {
        for (const char* const name : names) {
            if (ignored && options.command->count(name) > 0) {
                print_note("note: " + std::string(name) + " is ignored: " + by + " does not read it");
            }
        }
    };
    note(!physics, {"--effects", "--sign-velocity", "--own-motion"}, model);
    note(physics && derivatives, {"--own-motion"}, "input " + options.input);
    note(!structure.learns_parameters(), {"--prior"}, model);
    note(!physics, {"--torque-constants"}, model);
    note(cross_validation, {"--starts", "--refinement"}, "--hyper CV");
    note(!derivatives, {"--relevance"}, "input " + options.input);
    note(derivatives && !structure.features, {"--relevance"}, model);
    note(derivatives && cross_validation, {"--relevance"}, "--hyper CV");
    note(physics, {"--centred"}, model);
}

/// Returns the robot, if there is one. A model without physics uses it for the order of the joints and for
/// the check of the set-up.
std::optional<Robot> robot_of(const TrainOptions& options, OutputKind outputs,
                              const ModelTraining& training) {
    if (training.physics) {
        return training.physics->robot;
    }
    return options.robot.urdf.empty() ? std::nullopt : std::optional(options.robot.read(outputs));
}

std::vector<Recording> read_recordings(const TrainOptions& options, OutputKind outputs,
                                       const ModelTraining& training, const std::optional<Robot>& robot) {
    ReadOptions columns;
    columns.outputs = outputs;
    columns.joint_names = robot ? names_of_joints(*robot) : std::vector<std::string>{};
    columns.prismatic = robot ? prismatic_joints(*robot) : std::vector<bool>{};
    columns.velocity = columns.acceleration = // for the features, and for the rigid body with friction
        training.physics || (input_description(training.options.input).uses_derivatives() &&
                             training.derivatives != DerivativeSource::estimated);
    return options.recordings.read_each_once(columns);
}

/// Returns the sizes that no option sets.
FreeSizes free_sizes(const TrainOptions& options) {
    const ClockOptions& clock = options.clock;
    return {!clock.lags && !clock.window_s && !clock.every,
            options.command->count("--features-per-joint") == 0, options.command->count("--features") == 0,
            !clock.forgetting_factor && !clock.memory_s};
}

/// For a model with physics, fits the rigid body with friction for comparison in `replay`. It is fitted here,
/// because only the training recordings may determine its coefficients.
void fit_rigid_body_of(TrainedModel& model, const ModelTraining& training,
                       std::span<const Recording> recordings) {
    if (model.physics) {
        const Activity activity("fitting a rigid body with friction to compare with");
        PhysicsModel& physics = *model.physics;
        physics.rigid_body =
            fit_rigid_body(training.physics->robot, physics.chain, physics.output_gain,
                           sign_velocity_of(physics.effects).value_or(usual_sign_velocity), recordings);
    }
}

/// Derivatives over the long windows of a fast recording take their time.
PreparedTraining prepared_samples(std::span<const Recording> recordings, const ModelTraining& training) {
    const Activity activity("preparing the samples");
    return prepare_training(recordings, training);
}

int run(const TrainOptions& options) {
    const JsonOutput output(options.json);
    check_outputs({options.model, options.header}, options.recordings.with({options.robot.urdf}));
    const OutputKind outputs = parse_output_kind(options.outputs);
    ModelTraining training = model_training(options, outputs);
    note_ignored(options);
    const std::optional<Robot> robot = robot_of(options, outputs, training);
    const std::size_t constants = options.torque_constants.size();
    check_torque_constants(options.torque_constants, outputs, robot ? robot->joints.size() : constants);
    const std::vector<Recording> recordings = read_recordings(options, outputs, training, robot);
    if (!options.setup.accept(recordings, {outputs, robot ? &*robot : nullptr, options.torque_constants})) {
        return 1;
    }
    const double period_s = sample_period_s(recordings);
    options.clock.apply(training.options, period_s, options.sizes.given() && free_sizes(options).features);
    const ProgressCallback progress = progress_line(training.options.hyper);
    ModelTrainingResult result =
        options.sizes.given()
            ? train_within(options.sizes, free_sizes(options), recordings, outputs, training, progress)
            : train_model(prepared_samples(recordings, training), outputs, training, progress);
    TrainedModel& model = result.model;
    model.training.recordings = file_names(recordings);
    describe_reading(options.recordings, robot, model);
    {
        const Activity activity("calibrating the limits of innovations and contacts");
        calibrate_innovation_limit(model, recordings);
        if (outputs != OutputKind::wrench) {
            model.contact = measure_contact_limits(model, recordings);
        }
    }
    fit_rigid_body_of(model, training, recordings);
    FileSet files;
    add_model(files, model, options.model, options.header);
    files.commit();
    output.print(outcome_json(result, find_target(options.sizes.target)));
    print_outcome(result, listed(model.training.recordings));
    std::cout << describe_clock(training.options, period_s) << '\n';
    print_footprint(std::cout, model, find_target(options.sizes.target));
    return 0;
}

/// Adds the options that define the model, and its files.
void add_model_options(CLI::App& command, TrainOptions& options) {
    command
        .add_option("--outputs", options.outputs,
                    "What to predict: tau (torques), i (motor currents), wrench")
        ->required()
        ->type_name("tau|i|wrench");
    command
        .add_option("--model", options.structure,
                    "Structure of the model: features (NP), the robot (P), or both")
        ->check(one_of(structure_names()))
        ->capture_default_str();
    command.add_option("--input", options.input, "Input of the features, computed from the positions")
        ->check(one_of(words_of(input_names(","))))
        ->capture_default_str();
    command
        .add_option("--hyper", options.hyper,
                    "Estimation of the hyperparameters: marginal likelihood, or cross validation over a grid")
        ->check(one_of({"ML", "CV"}))
        ->capture_default_str();
    command.add_option("-o,--output", options.model, "The model")->required()->type_name("M.json");
    command.add_option("--header", options.header, "The same model as C++ constants for flash")
        ->type_name("M.hpp");
    command
        .add_option("--derivatives", options.derivatives,
                    "Input STD: columns qd and qdd of the recording, or estimated from the positions")
        ->check(one_of({"auto", "estimated", "measured"}))
        ->capture_default_str();
}

} // namespace

void add_train_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<TrainOptions>();
    CLI::App* command =
        app.add_subcommand("train", "Fits hyperparameters and the start of learning to recordings");
    options->command = command;
    options->recordings.add_to(*command);
    add_model_options(*command, *options);
    options->clock.add_to(*command);
    options->sizes.add_to(*command);
    options->setup.add_to(*command);
    add_training_options(*command, options->training);
    add_physics_options(*command, *options);
    const std::string friction =
        std::string(effect_kinds::viscous_friction.name) + ',' + effect_kinds::coulomb_friction.name;
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn train --log run.csv --rows :3400 --outputs i --input DFR -o model.json\n"
        "  dfdyn train --log run.csv --outputs tau --model SPK --robot arm.urdf --tip tool0"
        " --effects " +
        friction +
        " -o model.json\n"
        "Exit status: 0 done, 1 a mistake in the set-up of a recording (nothing is trained), 2 bad usage or "
        "input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
