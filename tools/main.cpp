// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/quiet.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/options/json_output.hpp"
#include "tools/commands/options/usage_error.hpp"

#include <exception>
#include <filesystem>
#include <iostream>

#ifdef __GLIBC__
#include <malloc.h>
#endif

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

/// Runs the subcommand of the command line. Returns the exit status; throws InputError for wrong usage or
/// input.
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

/// Keeps freed memory instead of returning it to the system at once. Training allocates and frees matrices of
/// megabytes for each evaluation; by default glibc maps and unmaps them, and the page faults of the next use
/// take 40 % of the time. 32 MiB is the largest threshold that glibc accepts.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest_on_heap = 32 << 20;
    constexpr int kept_on_top = 1 << 30;
    ::mallopt(M_MMAP_THRESHOLD, largest_on_heap);
    ::mallopt(M_TRIM_THRESHOLD, kept_on_top);
#endif
}

} // namespace

} // namespace dfdyn::tools

/// Exit status: 0 success, 1 the work was done and its result is negative, 2 wrong usage or input, 3 an
/// internal error of the program.
int main(int argc, char** argv) {
    dfdyn::tools::keep_freed_memory();
    try {
        return dfdyn::tools::run_program(argc, argv);
    } catch (const dfdyn::tools::InputError& error) {
        std::cerr << "dfdyn: " << error.what() << '\n';
        return 2;
    } catch (const std::filesystem::filesystem_error& error) { // a name that the system refuses
        std::cerr << "dfdyn: " << dfdyn::tools::shown(error.path1())
                  << ": cannot be used: " << error.code().message() << '\n';
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "dfdyn: internal error: " << error.what() << '\n';
        return 3;
    }
}
