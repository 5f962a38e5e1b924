// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/monitor_options.hpp"

#include "tools/base/text/json_text.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iostream>
#include <optional>

namespace dfdyn::tools {

void MonitorOptions::add_to(CLI::App& command) {
    command.add_flag("--monitor", chosen,
                     "Watch the innovations for a change of the arm or its sensors, and report what changed "
                     "(docs/guide/monitor.md)");
    command.add_option("--changes", file, "Write the changes here; implies --monitor")
        ->type_name("CHANGES.json");
    command
        .add_option(
            "--false-alarms", false_alarm_hours,
            "With --monitor: hours between two false alarms, on average; default: 5, the rate that was "
            "measured")
        ->check(number_in(0.01, 1e5))
        ->type_name("HOURS");
    robot.add_to(command, false);
    command.get_option("--robot")->description("With --monitor: the arm, for models without physics");
}

MonitorSetup MonitorOptions::setup(std::span<const TrainedModel> models, const std::string& source) const {
    const auto physical =
        std::ranges::find_if(models, [](const TrainedModel& model) { return model.physics.has_value(); });
    const TrainedModel& model = physical == models.end() ? models.front() : *physical;
    std::optional<Robot> arm;
    if (!robot.urdf.empty()) {
        arm = robot.read(kind_of_outputs(model.outputs.names, static_cast<std::size_t>(model.joints)));
    }
    MonitorSetup setup = monitor_setup(model, arm ? &*arm : nullptr, source);
    setup.false_alarm_hours = false_alarm_hours.value_or(default_false_alarm_hours);
    return setup;
}

nlohmann::ordered_json MonitorOptions::json(std::span<const RecordedChanges> changes) const {
    return changes_json(changes, false_alarm_hours.value_or(default_false_alarm_hours));
}

void MonitorOptions::show(std::span<const RecordedChanges> changes) const {
    std::size_t count = 0;
    for (const RecordedChanges& recorded : changes) {
        print_changes(std::cout, recorded);
        count += recorded.changes.size();
    }
    std::cout << "changes: " << count << '\n';
}

void MonitorOptions::add_file(std::span<const RecordedChanges> changes, FileSet& files) const {
    if (!file.empty()) {
        files.add(file, json_text(json(changes)) + '\n');
    }
}

} // namespace dfdyn::tools
