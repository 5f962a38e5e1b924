// SPDX-License-Identifier: Apache-2.0
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options.hpp"
#include "tools/common/atomic_file.hpp"
#include "tools/common/progress.hpp"
#include "tools/evaluation/replay.hpp"
#include "tools/evaluation/replay_csv.hpp"
#include "tools/evaluation/replay_report.hpp"
#include "tools/evaluation/replay_summary.hpp"
#include "tools/model/model_file.hpp"
#include "tools/report/report.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

namespace {

struct ReplayOptions {
    std::filesystem::path model;
    RecordingOptions recordings;
    std::filesystem::path csv;
    std::filesystem::path report;
    std::size_t horizon = 25;
    bool from_prior = false;
};

std::vector<ReplayedRecording> replay_all(const ReplayOptions& options, const TrainedModel& model,
                                          HostEstimator& estimator) {
    const OutputKind kind = kind_of_outputs(model.outputs.names, static_cast<std::size_t>(model.joints));
    ReadOptions columns;
    columns.joint_count = static_cast<std::size_t>(model.joints);
    columns.outputs = kind;
    columns.velocity = columns.acceleration = needs_derivatives(model);
    std::vector<ReplayedRecording> replayed;
    for (const Recording& recording : options.recordings.read(columns)) {
        Progress progress("replaying " + recording.source, recording.row_count());
        replayed.push_back(replay(estimator, model, recording, options.horizon,
                                  [&progress](std::size_t done) { progress.update(done); }));
    }
    return replayed;
}

int run(const ReplayOptions& options) {
    std::vector<std::filesystem::path> inputs = options.recordings.logs;
    inputs.push_back(options.model);
    check_distinct({options.csv, options.report}, std::move(inputs));
    const TrainedModel model = read_model(options.model);
    const auto estimator = make_estimator(model, options.from_prior);
    const std::vector<ReplayedRecording> replayed = replay_all(options, model, *estimator);
    const ReplaySummary summary = summarise(model, *estimator, replayed, options.horizon);
    if (!options.csv.empty()) {
        AtomicFile file(options.csv);
        write_replay_csv(file.stream(), model, replayed);
        file.commit();
    }
    if (!options.report.empty()) {
        write_file(options.report, render_report(make_replay_report(model, replayed, summary)));
    }
    print_summary(std::cout, summary);
    return 0;
}

} // namespace

void add_replay_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<ReplayOptions>();
    CLI::App* command =
        app.add_subcommand("replay", "Runs the embedded estimator, tick by tick, over recordings");
    command->add_option("--model", options->model, "Model that `dfdyn train` wrote")
        ->required()
        ->type_name("M.json");
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
