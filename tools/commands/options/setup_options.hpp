// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/setup_check/setup_check.hpp"

#include <CLI/CLI.hpp>

#include <vector>

namespace dfdyn::tools {

/// The option that skips the set-up check.
struct SetupOptions {
    bool unchecked = false;

    void add_to(CLI::App& command);

    /// Prints the findings of check_setup() for each recording on stderr, one line each. Returns whether work
    /// may start: no mistake, or not checked.
    bool accept(const std::vector<Recording>& recordings, const SetupQuestion& question) const;
};

} // namespace dfdyn::tools
