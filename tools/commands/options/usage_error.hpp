// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <span>
#include <string>

namespace dfdyn::tools {

/// Returns the message for a command line that `app` refused with `failure`, in one line: what was expected,
/// what was found, the nearest known name of an unknown subcommand or option, and how to get help.
std::string usage_message(const CLI::App& app, const CLI::ParseError& failure);

/// Throws InputError if an option of the command line is followed by another option instead of its value, as
/// in `replay --log --model m.json`. Call before `app` parses, which takes the second option as the value.
void refuse_missing_values(const CLI::App& app, std::span<char* const> arguments);

/// Throws InputError if a given option of the chosen subcommand has an empty value, such as an unset variable
/// of a script, or a file whose ending fits another option, such as `--model run.csv --log model.json`.
void refuse_wrong_values(const CLI::App& app);

} // namespace dfdyn::tools
