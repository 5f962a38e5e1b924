// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options with which every subcommand names its robot.
struct RobotOptions {
    std::filesystem::path urdf; ///< empty: none given
    std::string tip, base, ft_joint, wrench_direction;
    std::vector<double> gravity; ///< three, or none: the default

    void add_to(CLI::App& command, bool required);

    /// Reads it and says its notes once on stderr. Throws InputError also where `outputs` is a wrench and the
    /// chain has no sensor.
    Robot read(OutputKind outputs) const;
};

/// Reads the chain of the robot `urdf` that the scenario is about, with its tip moved to the scenario's
/// point.
Robot read_scenario_robot(const std::filesystem::path& urdf, const std::filesystem::path& scenario);

} // namespace dfdyn::tools
