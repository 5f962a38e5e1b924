// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/row_parts.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/system/progress.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/clock_options.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/model_files.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/commands/options/setup_options.hpp"
#include "tools/commands/options/size_options.hpp"
#include "tools/diagnosis/extension/extended_model.hpp"
#include "tools/diagnosis/output/diagnosis_json.hpp"
#include "tools/diagnosis/output/diagnosis_page.hpp"
#include "tools/diagnosis/output/diagnosis_summary.hpp"
#include "tools/diagnosis/output/error_sections.hpp"
#include "tools/diagnosis/recordings/diagnose_recordings.hpp"
#include "tools/replay/contacts/contact_limits.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay_csv.hpp"
#include "tools/replay/replay_report.hpp"
#include "tools/report/report.hpp"
#include "tools/start/project.hpp"
#include "tools/start/recording_overview.hpp"
#include "tools/training/data/recorded_data.hpp"
#include "tools/training/search/training_setup.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

namespace dfdyn::tools {

namespace start_command {

constexpr double training_share = 0.7;
constexpr double same_error = 1.02; ///< of errors within 2 %, the model with less flash is chosen

struct StartOptions {
    RecordingOptions recordings;
    RobotOptions robot;
    SetupOptions setup;
    SizeOptions sizes;
    std::string outputs;
    std::filesystem::path folder;
    bool quick = false;
    bool json = false;
};

/// Recordings and description of the arm before training.
struct Arm {
    std::optional<Robot> robot;
    OutputKind outputs = OutputKind::joint_torque;
    std::vector<Recording> recordings;

    const Robot* robot_or_null() const { return robot ? &*robot : nullptr; }
};

struct Candidate {
    std::string name;
    TrainedModel model;
    ModelNeeds needs;
    double error = 0; ///< on the held-out rows
};

void say(const std::string& step) { std::cout << "\n== " << step << '\n'; }

/// Reads the recordings with the outputs that they have: torques, otherwise currents, otherwise a wrench.
Arm read_arm(const StartOptions& options) {
    Arm arm;
    const bool chosen = !options.outputs.empty();
    const OutputKind kind = chosen ? parse_output_kind(options.outputs) : OutputKind::joint_torque;
    ReadOptions columns;
    if (!options.robot.urdf.empty()) {
        arm.robot = options.robot.read(kind);
        columns = columns_for(*arm.robot, kind);
    }
    columns.outputs = chosen ? std::optional(kind) : std::nullopt;
    columns.output_choices = {OutputKind::joint_torque, OutputKind::motor_current, OutputKind::wrench};
    try {
        arm.recordings = options.recordings.read_each_once(columns);
    } catch (const MissingColumns& failure) {
        throw InputError(
            failure.what() +
            std::string(chosen ? "" : "; start also accepts motor currents (i) or a wrench as outputs"));
    }
    const Recording& first = arm.recordings.front();
    arm.outputs = kind_of_outputs(first.output.names, first.joint_count());
    if (arm.robot) {
        options.robot.require_sensor(*arm.robot, arm.outputs);
    }
    return arm;
}

/// Throws InputError if gaps leave no complete windows to train on, before the diagnosis takes its time.
void require_windows(const std::vector<Recording>& recordings) {
    ModelTraining training;
    ClockOptions{}.apply(training.options, sample_period_s(recordings));
    choose_rows(gather_training_data(recordings), training.options);
}

void print_recordings(const Arm& arm, bool chosen_here) {
    if (chosen_here) {
        std::cout << "outputs: " << listed(arm.recordings.front().output.names)
                  << ", which the recording has (--outputs chooses others)\n";
    }
    print_overview(std::cout, arm.recordings);
}

/// Diagnoses the robot on the training rows. Adds pages to `files`, and the extended model to `candidates`.
void diagnose_robot(const Arm& arm, std::vector<Recording> training, const StartOptions& options,
                    FolderContent& files, std::vector<Candidate>& candidates) {
    say("diagnosis of " + arm.robot->name + " on the training rows");
    DiagnosisOptions how;
    how.outputs = arm.outputs;
    how.measure = false;
    how.check_setup = !options.setup.unchecked;
    DiagnosisWork work = diagnose_recordings(*arm.robot, training, how, false);
    work.diagnosis.scope = "the first " + std::to_string(total_rows(training)) + " of " +
                           std::to_string(total_rows(arm.recordings)) + " rows";
    const ModelExtension extension = effects_fitted(work) ? extension_of(work) : ModelExtension{};
    files["diagnosis.json"] = json_text(diagnosis_json(work.diagnosis)) + '\n';
    const std::string curves = "diagnosis_curves.csv";
    files["diagnosis.html"] = diagnosis_page({*arm.robot, training, work, extension, OnlineView{}, curves});
    print_diagnosis(std::cout, work.diagnosis, extension.carried);
    if (effects_fitted(work)) {
        std::ostringstream table;
        write_comparison_csv(table, work);
        files[curves] = std::move(table).str(); // may be large
        const Activity activity("building the extended model");
        candidates.push_back({"the robot with the causes found", extended_model(extension, training), {}, 0});
    }
}

/// Throws InputError if models cannot be compared. The choice of sizes splits the training rows again.
void require_varying(const SplitRecordings& split) {
    require_varying_outputs(split.judging, "the last 30 % of the rows");
    require_varying_outputs(split_recordings(split.training, training_share).judging,
                            "the rows from 49 % to 70 %");
}

/// Trains the black-box model that fits the budget.
Candidate train_network(const Arm& arm, const SplitRecordings& split, const StartOptions& options) {
    say("training a network of random features that fits " + to_text(options.sizes.budget()));
    ModelTraining training;
    ClockOptions{}.apply(training.options, sample_period_s(split.training));
    if (options.quick) {
        training.options.starts = 1;
        training.options.likelihood_rows = 200;
        training.options.refinement_evaluations = 0;
    }
    Progress progress("maximising the marginal likelihood", 0);
    const auto show = [&](const TrainingProgress& at) {
        progress.update(static_cast<std::size_t>(at.evaluations));
    };
    const FreeSizes free{.window = true, .rows = false, .features = true, .memory = false};
    TrainedModel model = train_within(options.sizes, free, split.training, arm.outputs, training, show).model;
    calibrate_innovation_limit(model, split.training);
    if (arm.outputs != OutputKind::wrench) {
        model.contact = measure_contact_limits(model, split.training);
    }
    return {"a network of random features", std::move(model), {}, 0};
}

/// Prints the candidates with their errors; returns the best one that fits.
const Candidate& choose(std::vector<Candidate>& candidates, const SplitRecordings& split,
                        const TargetBudget& budget) {
    say("comparison on the last 30 % of the rows, which were not used for training");
    const Candidate* best = nullptr;
    for (Candidate& one : candidates) {
        const Activity activity("replaying " + one.name);
        one.needs = needs_of(one.model);
        one.error = held_out_error(one.model, split.judging);
        const bool fitting = fits(one.needs, budget);
        std::cout << "  " << one.name << ": nRMSE " << rounded_text(one.error) << ", " << to_text(one.needs)
                  << (fitting ? "\n" : " (beyond the budget)\n");
        const auto better = [&](const Candidate& other) {
            return one.needs.flash_bytes < other.needs.flash_bytes ? one.error <= same_error * other.error
                                                                   : same_error * one.error < other.error;
        };
        if (fitting && (best == nullptr || better(*best))) {
            best = &one;
        }
    }
    if (best == nullptr) {
        throw InputError("the budget (--flash, --ram): expected room for one of the models above, found " +
                         to_text(budget));
    }
    if (!std::isfinite(best->error)) {
        throw InputError(
            split.judging.front().source +
            ": expected motion in the last 30 % of the rows as in those before, found none that the "
            "model predicts: record longer, with more varied motion");
    }
    std::cout << "chosen: " << best->name << ": "
              << (candidates.size() > 1 ? "the least error; within 2 % the least flash\n" : "the only one\n");
    if (!(best->error < 1)) { // the error of predicting the mean
        std::cerr
            << "warning: on rows not used for training, the model predicts no better than the mean (nRMSE "
            << rounded_text(best->error) << "): record longer, with more varied motion\n";
    }
    return *best;
}

/// Replays the held-out rows with the chosen model; adds the report to `files`.
void replay_held_out(const TrainedModel& model, const SplitRecordings& split, FolderContent& files) {
    say("replay of the last 30 % of the rows");
    const auto estimator = make_estimator(model, false);
    std::vector<ReplayedRecording> replayed;
    for (const Recording& recording : split.judging) {
        Progress progress("replaying " + recording.source, recording.row_count());
        replayed.push_back(
            replay(*estimator, {&model, 1}, recording, 0, [&](std::size_t done) { progress.update(done); }));
    }
    const ReplaySummary summary = summarise({&model, 1}, *estimator, replayed, 0);
    Report report = make_replay_report(model, replayed, summary);
    if (has_thinned_page(report)) {
        report.full_data = "report.ticks.csv";
        std::ostringstream ticks;
        write_replay_csv(ticks, model, replayed);
        files[report.full_data] = std::move(ticks).str(); // may be large
    }
    files["report.html"] = render_report(report);
    print_summary(std::cout, summary);
}

/// Describes the training in the model, so that `replay` reads recordings in the same way.
void describe_training(TrainedModel& model, const Arm& arm, const StartOptions& options) {
    model.training.recordings = file_names(arm.recordings);
    describe_reading(options.recordings, arm.robot, model);
    model.training.rows = "first 70 %";
}

/// Returns commands for the project in `folder`, one per line. `core`: name of the target.
std::string next_steps(const std::filesystem::path& folder, const std::string& core) {
    const auto word = [](const std::filesystem::path& path) { return shell_word(path.string()); };
    const std::string configure = "  cmake -S " + word(folder) + " -B ";
    const std::string build = word(folder / "build");
    const std::string build_arm = word(folder / "build-arm");
    return configure + build + " && cmake --build " + build + " && " + word(folder / "build/replay_ticks") +
           "\n" + configure + build_arm +
           " -DCMAKE_TOOLCHAIN_FILE=cmake/cortex-m.cmake -DDFDYN_CORE=" + core + " && cmake --build " +
           build_arm + " --target run\n  dfdyn replay --model " + word(folder / "model.json") +
           " --log another.csv --report another.html\n";
}

nlohmann::ordered_json json_of(const std::vector<Candidate>& candidates, const Candidate& chosen,
                               const StartOptions& options) {
    nlohmann::ordered_json json{
        {"schema", "dfdyn.start/1"},
        {"folder", options.folder.string()},
        {"candidates", nlohmann::ordered_json::array()},
        {"chosen", chosen.name},
        {"footprint", footprint_json(chosen.model, find_target(options.sizes.target))}};
    for (const Candidate& one : candidates) {
        json["candidates"].push_back({{"name", one.name},
                                      {"held_out_nrmse", one.error},
                                      {"flash_bytes", one.needs.flash_bytes},
                                      {"ram_bytes", one.needs.ram_bytes}});
    }
    return json;
}

int run(StartOptions options) {
    const JsonOutput output(options.json);
    require_new_folder(options.folder);
    options.sizes.flash_bytes = options.sizes.flash_bytes.value_or(512 * 1024);
    options.sizes.ram_bytes = options.sizes.ram_bytes.value_or(256 * 1024);
    const Arm arm = read_arm(options);
    say("the recording");
    print_recordings(arm, options.outputs.empty());
    if (!options.setup.accept(arm.recordings, {arm.outputs, arm.robot_or_null()})) {
        return 1;
    }
    require_windows(arm.recordings);
    std::cout << "the set-up shows no mistake\n";
    SplitRecordings split = split_recordings(arm.recordings, training_share);
    require_varying(split);
    FolderContent files;
    std::vector<Candidate> candidates;
    candidates.push_back(
        train_network(arm, split, options)); // first: it finds out at once whether the budget is too small
    if (arm.robot) {
        diagnose_robot(arm, std::move(split.training), options, files, candidates);
    }
    const Candidate& chosen = choose(candidates, split, options.sizes.budget());
    TrainedModel model = chosen.model;
    describe_training(model, arm, options);
    replay_held_out(model, split, files);
    files.merge(project_files(model, split.judging));
    files["model.json"] = checked_json(model, options.folder / "model.json");
    files["README.txt"] =
        "Written by dfdyn start. Next, in this folder:\n" + next_steps(".", options.sizes.target);
    write_folder(options.folder, files);
    output.print(json_of(candidates, chosen, options));
    say("result");
    print_footprint(std::cout, model, find_target(options.sizes.target));
    std::cout << options.folder.string() << " has report.html, model.json"
              << (arm.robot ? ", diagnosis.html" : "")
              << ", include/robot_model.hpp and a CMake project. Next:\n"
              << next_steps(options.folder, options.sizes.target);
    return 0;
}

} // namespace start_command

void add_start_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<start_command::StartOptions>();
    CLI::App* command = app.add_subcommand("start", "Makes a controller from a recording: checks, diagnoses, "
                                                    "trains what fits, replays, writes a project");
    options->recordings.add_to(*command);
    options->robot.add_to(*command, false);
    command
        ->add_option("--outputs", options->outputs,
                     "What to predict: tau (torques), i (motor currents), wrench; default: the first of them "
                     "that the recording has")
        ->type_name("tau|i|wrench");
    command->add_option("-o,--output", options->folder, "New folder for the results")
        ->required()
        ->type_name("DIR");
    command->add_flag("--quick", options->quick, "A first look: one short search for the hyperparameters");
    options->sizes.add_to(*command);
    options->setup.add_to(*command);
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn start --log run.csv -o controller\n"
        "  dfdyn start --log run.csv --robot arm.urdf --tip tool0 --flash 512K --ram 256K -o controller\n"
        "Without --flash and --ram: 512K and 256K. The folder appears at the end, as a whole.\n"
        "Exit status: 0 done, 1 a mistake in the set-up of a recording (nothing is written), 2 bad usage or "
        "input.");
    command->callback([options, &chosen] { chosen = [options] { return start_command::run(*options); }; });
}

} // namespace dfdyn::tools
