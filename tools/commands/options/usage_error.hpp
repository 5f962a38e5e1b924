// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace dfdyn::tools {

/// Returns the message for a command line that `app` refused with `failure`, in one line: an unknown
/// subcommand or option with the nearest known one, otherwise what `failure` reports; then how to get help.
std::string usage_message(const CLI::App& app, const CLI::ParseError& failure);

} // namespace dfdyn::tools
