// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/robot/robot.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options for the robot, common to all subcommands.
struct RobotOptions {
    std::filesystem::path urdf; ///< empty: none given
    std::string tip, base, ft_joint, wrench_direction;
    std::vector<double> gravity; ///< three values, or empty: the default

    void add_to(CLI::App& command, bool required);

    /// Reads the robot and prints its notes once on stderr. Throws InputError also if `outputs` is a wrench
    /// and the chain has no sensor.
    Robot read(OutputKind outputs) const;

    /// Throws InputError if `outputs` is a wrench and the chain of `robot`, as read(), has no sensor.
    void require_sensor(const Robot& robot, OutputKind outputs) const;
};

/// Returns the columns to read for this robot: positions of its joints, and the outputs.
ReadOptions columns_for(const Robot& robot, OutputKind outputs);

/// Reads the scenario's chain of the robot `urdf`, with its tip moved to the scenario's point.
Robot read_scenario_robot(const std::filesystem::path& urdf, const std::filesystem::path& scenario);

} // namespace dfdyn::tools
