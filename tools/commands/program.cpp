// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/program.hpp"

#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/usage_error.hpp"

#include <iostream>

namespace dfdyn::tools {

namespace {

/// Adds all subcommands, each with the option --quiet.
void add_commands(CLI::App& app, Command& command) {
    add_start_command(app, command);
    add_train_command(app, command);
    add_footprint_command(app, command);
    add_replay_command(app, command);
    add_identify_command(app, command);
    add_evaluate_command(app, command);
    add_simulate_command(app, command);
    add_convert_command(app, command);
    add_play_command(app, command);
    add_loop_command(app, command);
    add_plant_command(app, command);
    add_buscheck_command(app, command);
    add_diagnose_command(app, command);
    add_bench_command(app, command);
    add_man_command(app, command);
    add_completion_command(app, command);
    for (CLI::App* const subcommand : app.get_subcommands([](const CLI::App*) { return true; })) {
        subcommand->add_flag_callback(
            "--quiet", be_quiet, "No progress and no notes on standard error; warnings and errors remain");
    }
}

} // namespace

int run_program(int argc, char** argv) {
    CLI::App app("Learns a robot arm's inverse dynamics from joint positions, tick by tick, in fixed memory.",
                 "dfdyn");
    app.require_subcommand(1);
    app.set_version_flag("--version", build_flags());
    Command command;
    add_commands(app, command);
    refuse_missing_values(app, {argv, static_cast<std::size_t>(argc)});
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& request) {
        const int done = app.exit(request); // --help, --version
        flush_standard_output(std::cout);
        return done;
    } catch (const CLI::ParseError& failure) {
        throw InputError(usage_message(app, failure));
    }
    refuse_wrong_values(app);
    const int status = command();
    flush_standard_output(std::cout);
    return status;
}

} // namespace dfdyn::tools
