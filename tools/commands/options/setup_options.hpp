// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/setup_check/setup_check.hpp"

#include <CLI/CLI.hpp>

#include <vector>

namespace dfdyn::tools {

/// The option that leaves out the check of the set-up.
struct SetupOptions {
    bool unchecked = false;

    void add_to(CLI::App& command);

    /// Prints what check_setup() finds in each recording on stderr, a line each. Returns whether work may
    /// start: no mistake, or unchecked.
    bool accept(const std::vector<Recording>& recordings, const SetupQuestion& question) const;
};

} // namespace dfdyn::tools
