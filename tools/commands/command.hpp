// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace dfdyn::tools {

/// The work of a subcommand after its options are parsed; returns the program's exit status.
using Command = std::function<int()>;

/// Each function adds a subcommand to `app` and stores its work in `chosen` if the user calls it.
void add_start_command(CLI::App& app, Command& chosen);
void add_train_command(CLI::App& app, Command& chosen);
void add_footprint_command(CLI::App& app, Command& chosen);
void add_replay_command(CLI::App& app, Command& chosen);
void add_identify_command(CLI::App& app, Command& chosen);
void add_evaluate_command(CLI::App& app, Command& chosen);
void add_simulate_command(CLI::App& app, Command& chosen);
void add_convert_command(CLI::App& app, Command& chosen);
void add_diagnose_command(CLI::App& app, Command& chosen);
void add_play_command(CLI::App& app, Command& chosen);
void add_loop_command(CLI::App& app, Command& chosen);
void add_plant_command(CLI::App& app, Command& chosen);
void add_buscheck_command(CLI::App& app, Command& chosen);
void add_bench_command(CLI::App& app, Command& chosen);
void add_man_command(CLI::App& app, Command& chosen);
void add_completion_command(CLI::App& app, Command& chosen);

} // namespace dfdyn::tools
