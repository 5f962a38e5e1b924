// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace dfdyn::tools {

/// Returns the message for a command line that `app` refused with `failure`, in one line: what was expected,
/// what was found, the nearest known name of an unknown subcommand or option, and how to get help.
std::string usage_message(const CLI::App& app, const CLI::ParseError& failure);

/// Throws InputError if a given option of the chosen subcommand has an empty value, such as an unset variable
/// of a script.
void refuse_empty_values(const CLI::App& app);

} // namespace dfdyn::tools
