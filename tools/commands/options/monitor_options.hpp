// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/commands/options/robot_options.hpp"
#include "tools/monitor/monitored_estimator.hpp"

#include <span>

namespace dfdyn::tools {

/// The options of a replay with a monitor.
struct MonitorOptions {
    bool chosen = false;
    std::filesystem::path file; ///< changes.json; empty: none
    double false_alarm_hours = 5;
    RobotOptions robot; ///< for models without physics

    bool wanted() const { return chosen || !file.empty(); }

    void add_to(CLI::App& command);

    /// Returns the set-up from the first model with physics, otherwise from the robot. Throws InputError,
    /// naming `source`, if there is neither.
    MonitorSetup setup(std::span<const TrainedModel> models, const std::string& source) const;

    /// Prints the changes, and writes the file if one was requested.
    void show(std::span<const RecordedChanges> changes) const;
};

} // namespace dfdyn::tools
