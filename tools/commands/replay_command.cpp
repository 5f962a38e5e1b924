// SPDX-License-Identifier: Apache-2.0
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options.hpp"
#include "tools/common/atomic_file.hpp"
#include "tools/common/error.hpp"
#include "tools/common/progress.hpp"
#include "tools/common/text.hpp"
#include "tools/evaluation/replay.hpp"
#include "tools/evaluation/replay_csv.hpp"
#include "tools/evaluation/replay_report.hpp"
#include "tools/evaluation/replay_summary.hpp"
#include "tools/model/model_file.hpp"
#include "tools/report/report.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct ReplayOptions {
    std::vector<std::filesystem::path> models; ///< several: combined
    RecordingOptions recordings;
    std::filesystem::path csv;
    std::filesystem::path report;
    std::size_t horizon = 25;
    bool from_prior = false;
};

/// Models of the same joints and outputs.
std::vector<TrainedModel> read_models(const std::vector<std::filesystem::path>& paths) {
    std::vector<TrainedModel> models;
    for (const std::filesystem::path& path : paths) {
        models.push_back(read_model(path));
        const TrainedModel& first = models.front();
        const TrainedModel& last = models.back();
        if (last.joints != first.joints || last.outputs.names != first.outputs.names) {
            throw InputError(shown(path) + ": expected joints and outputs as in " + shown(paths.front()) +
                             ", " + std::to_string(first.joints) + " and " + listed(first.outputs.names) +
                             ", found " + std::to_string(last.joints) + " and " + listed(last.outputs.names));
        }
    }
    return models;
}

std::vector<ReplayedRecording> replay_all(const ReplayOptions& options, std::span<const TrainedModel> models,
                                          HostEstimator& estimator) {
    const auto joints = static_cast<std::size_t>(models.front().joints);
    ReadOptions columns;
    columns.joint_count = joints;
    columns.outputs = kind_of_outputs(models.front().outputs.names, joints);
    columns.velocity = columns.acceleration = std::ranges::any_of(models, needs_derivatives);
    std::vector<ReplayedRecording> replayed;
    for (const Recording& recording : options.recordings.read(columns)) {
        Progress progress("replaying " + recording.source, recording.row_count());
        replayed.push_back(replay(estimator, models, recording, options.horizon,
                                  [&progress](std::size_t done) { progress.update(done); }));
    }
    return replayed;
}

int run(const ReplayOptions& options) {
    std::vector<std::filesystem::path> inputs = options.recordings.logs;
    inputs.insert(inputs.end(), options.models.begin(), options.models.end());
    check_distinct({options.csv, options.report}, std::move(inputs));
    const std::vector<TrainedModel> models = read_models(options.models);
    const auto estimator = make_estimator(models, options.from_prior);
    const std::vector<ReplayedRecording> replayed = replay_all(options, models, *estimator);
    const ReplaySummary summary = summarise(models, *estimator, replayed, options.horizon);
    if (!options.csv.empty()) {
        AtomicFile file(options.csv);
        write_replay_csv(file.stream(), models.front(), replayed);
        file.commit();
    }
    if (!options.report.empty()) {
        write_file(options.report, render_report(make_replay_report(models.front(), replayed, summary)));
    }
    print_summary(std::cout, summary);
    return 0;
}

} // namespace

void add_replay_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<ReplayOptions>();
    CLI::App* command =
        app.add_subcommand("replay", "Runs the embedded estimator, tick by tick, over recordings");
    command
        ->add_option(
            "--model", options->models,
            "Model that `dfdyn train` wrote; several: their predictions are combined, each weighted by how "
            "well it predicted lately")
        ->required()
        ->delimiter(',')
        ->type_name("M.json[,...]");
    options->recordings.add_to(*command);
    command
        ->add_option("-o,--output", options->csv,
                     "One row per tick: measured, predicted, deviation, nis, learned, status")
        ->type_name("OUT.csv");
    command->add_option("--report", options->report, "Self-contained page with curves and figures")
        ->type_name("R.html");
    command->add_option("--horizon", options->horizon, "Samples T of the paper's index epsilon; 0: none")
        ->check(CLI::Range(0, 10000))
        ->capture_default_str();
    command->add_flag("--from-prior", options->from_prior,
                      "Start with nothing learned: keep the hyperparameters, drop the trained start");
    command->footer(
        "Example:\n  dfdyn replay --model model.json --log run.csv -o out.csv --report report.html\n"
        "Exit status: 0 done, 2 bad usage or input.");
    command->callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

} // namespace dfdyn::tools
