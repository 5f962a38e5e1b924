// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/named_change.hpp"

#include "tools/base/text/number.hpp"
#include "tools/monitor/recorded_time.hpp"

#include <nlohmann/json.hpp>

#include <ostream>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const RecordedChanges& recorded, const NamedChange& change) {
    ordered_json parameters = ordered_json::array();
    for (const ChangeParameter& parameter : change.parameters) {
        parameters.push_back(
            {{"name", parameter.name}, {"value", parameter.value}, {"unit", parameter.unit}});
    }
    ordered_json result{
        {"alarm", recorded_time_s(recorded.origin_s, change.alarm_ns)},
        {"onset", recorded_time_s(recorded.origin_s, change.onset_ns)},
        {"end", nullptr},
        {"cause", name(change.cause)},
        {"where", change.where},
        {"confidence", change.confidence},
        {"parameters", parameters},
        {"runner_up", {{"cause", name(change.runner_up)}, {"confidence", change.runner_up_confidence}}},
        {"shown_by", change.shown_by}};
    if (change.end_ns != 0) {
        result["end"] = recorded_time_s(recorded.origin_s, change.end_ns);
    }
    return result;
}

std::string sizes_of(const NamedChange& change) {
    std::string text;
    for (const ChangeParameter& parameter : change.parameters) {
        text.append(text.empty() ? ": " : ", ").append(parameter.name).append(" ");
        text.append(rounded_text(parameter.value)).append(" ").append(parameter.unit);
    }
    return text;
}

} // namespace

void print_changes(std::ostream& out, const RecordedChanges& recorded) {
    for (const NamedChange& change : recorded.changes) {
        out << recorded.recording << ": "
            << formatted("%.2f", recorded_time_s(recorded.origin_s, change.alarm_ns))
            << " s: " << name(change.cause) << (change.where.empty() ? "" : " at ") << change.where
            << sizes_of(change) << "; confidence " << formatted("%.2f", change.confidence) << ", since "
            << formatted("%.2f", recorded_time_s(recorded.origin_s, change.onset_ns)) << " s, else "
            << name(change.runner_up) << ' ' << formatted("%.2f", change.runner_up_confidence) << '\n';
    }
}

ordered_json changes_json(std::span<const RecordedChanges> recordings, double false_alarm_hours) {
    ordered_json list = ordered_json::array();
    for (const RecordedChanges& recorded : recordings) {
        ordered_json changes = ordered_json::array();
        for (const NamedChange& change : recorded.changes) {
            changes.push_back(to_json(recorded, change));
        }
        list.push_back({{"recording", recorded.recording}, {"changes", changes}});
    }
    return {{"schema", "dfdyn.changes/1"},
            {"hours_between_false_alarms", false_alarm_hours},
            {"recordings", list}};
}

} // namespace dfdyn::tools
