// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop_setup.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options of `dfdyn loop`.
struct LoopOptions {
    std::filesystem::path robot, scenario, model, bus, folder;
    std::filesystem::path restored, saved; ///< snapshots of the learned state
    std::filesystem::path calibrated;      ///< the model with measured limits of contacts
    std::string interface;
    bool simulate = false;
    bool from_prior = false;
    bool json = false;
    double duration_s = 0;
    double window_s = 5;
    LoopLimits limits;
    std::vector<std::string> on_finding; ///< cause=action
    std::string on_contact;
};

/// Runs the loop in a simulation or on a bus, and writes what the options ask for. Returns the exit status.
/// Throws InputError for options that contradict each other.
int run_loop_command(LoopOptions& options);

} // namespace dfdyn::tools
