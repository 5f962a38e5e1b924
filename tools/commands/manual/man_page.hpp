// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns the subcommands, in the order of the help text.
std::vector<const CLI::App*> subcommands(const CLI::App& program);

/// Returns the manual page (roff, section 1) of the program, or of its subcommand `command`, from the help
/// texts. `version`: such as "dfdyn 0.3.0".
std::string man_page(const CLI::App& program, const CLI::App* command, const std::string& version);

/// Returns a script for bash that completes subcommands, options, values of options that have names, and
/// files.
std::string bash_completion(const CLI::App& program);

} // namespace dfdyn::tools
