// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_set.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/monitor/monitored_estimator.hpp"

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <span>

namespace dfdyn::tools {

/// The options of a replay with a monitor.
struct MonitorOptions {
    bool chosen = false;
    std::filesystem::path file;                            ///< changes.json; empty: none
    static constexpr double default_false_alarm_hours = 5; ///< as measured
    std::optional<double> false_alarm_hours;
    RobotOptions robot; ///< for models without physics

    bool wanted() const { return chosen || !file.empty(); }

    /// Returns whether the user gave an option that only a monitor reads.
    bool has_choice() const { return false_alarm_hours || !robot.urdf.empty(); }

    void add_to(CLI::App& command);

    /// Returns the set-up from the first model with physics, otherwise from the robot. Throws InputError,
    /// naming `source`, if there is neither.
    MonitorSetup setup(std::span<const TrainedModel> models, const std::string& source) const;

    /// Returns the changes, as in the file.
    nlohmann::ordered_json json(std::span<const RecordedChanges> changes) const;

    /// Prints the changes.
    void show(std::span<const RecordedChanges> changes) const;
    /// Adds the file of the changes if one was requested.
    void add_file(std::span<const RecordedChanges> changes, FileSet& files) const;
};

} // namespace dfdyn::tools
