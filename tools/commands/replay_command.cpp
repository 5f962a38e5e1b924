// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/commands/replay_run.hpp"

#include <memory>

namespace dfdyn::tools {

namespace {

/// Adds the options for recordings that are logs of a CAN bus, and for a live bus.
void add_bus_options(CLI::App& command, ReplayOptions& options) {
    command
        .add_option("--bus", options.bus,
                    "The devices on a CAN bus (docs/reference/can.md): recordings are candump logs, or --can")
        ->type_name("B.json");
    command
        .add_option("--from", options.log_interface,
                    "Interface in the log whose frames are used, if it contains several")
        ->type_name("IFACE");
    command.add_option("--can", options.can.interface, "Instead of --log: this CAN interface, in real time")
        ->type_name("IFACE");
    command.add_option("--duration", options.can.duration_s, "Seconds, with --can; default: until Ctrl-C")
        ->check(number_in(0.0, 1e9))
        ->type_name("S");
    command.add_option("--record", options.can.record, "Log of what --can receives")->type_name("L.log");
}

/// Adds the options for what the replay writes and how it learns.
void add_result_options(CLI::App& command, ReplayOptions& options) {
    command
        .add_option("-o,--output", options.csv,
                    "One row per tick: measured, predicted, deviation, nis, learned, status. With --can the "
                    "file is updated every 0.25 s and can be read during the run")
        ->type_name("OUT.csv");
    command
        .add_option(
            "--report", options.report,
            "Self-contained page with curves and figures. Above 60000 ticks the curves contain the extremes "
            "only; R.ticks.csv in the same folder contains all ticks, unless -o writes them there")
        ->type_name("R.html");
    command
        .add_option("--horizon", options.horizon,
                    "Samples T of the paper's index epsilon; 0: none; default: 25, with --can 0")
        ->check(whole_number_in(0, 10000));
    command.add_flag("--from-prior", options.from_prior,
                     "Start with nothing learned: keep the hyperparameters, drop the trained start");
    command
        .add_flag("--frozen", options.frozen,
                  "Predict without learning: the recording's outputs do not change the model; errors and "
                  "innovations are reported as usual")
        ->excludes("--from-prior");
}

} // namespace

void add_replay_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<ReplayOptions>();
    CLI::App* command =
        app.add_subcommand("replay", "Runs the embedded estimator, tick by tick, over recordings");
    command
        ->add_option("--model", options->models,
                     "Model that `dfdyn train` wrote; several: their predictions are combined, each weighted "
                     "by its recent accuracy")
        ->required()
        ->delimiter(',')
        ->type_name("M.json[,...]");
    options->recordings.add_to(*command);
    command->get_option("--log")->required(false);
    add_bus_options(*command, *options);
    add_result_options(*command, *options);
    options->contacts.add_to(*command);
    options->monitor.add_to(*command);
    add_json_option(*command, options->json);
    command->footer(
        "Example:\n  dfdyn replay --model model.json --log run.csv -o out.csv --report report.html\n"
        "  dfdyn replay --model model.json --log unseen.csv --frozen\n"
        "  dfdyn replay --model model.json --log run.csv --monitor --changes changes.json\n"
        "  dfdyn replay --model model.json --log run.csv --contacts\n"
        "  dfdyn replay --model model.json --bus bus.json --log run.log -o out.csv\n"
        "  dfdyn replay --model model.json --bus bus.json --can can0 --record run.log -o out.csv\n"
        "Exit status: 0 done, 1 nothing was predicted (of several buses: by one of them), 2 bad usage or "
        "input.");
    command->callback([options, &chosen] { chosen = [options] { return run_replay_command(*options); }; });
}

} // namespace dfdyn::tools
