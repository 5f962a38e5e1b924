// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Runs the subcommand of the command line. Returns the exit status; throws InputError for wrong usage or
/// input.
int run_program(int argc, char** argv);

} // namespace dfdyn::tools
