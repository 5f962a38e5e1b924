// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/named_change.hpp"

#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/output_units.hpp"
#include "tools/monitor/monitored_estimator.hpp"
#include "tools/monitor/recorded_time.hpp"
#include "tools/robot/joint_unit.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
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

std::string numbered(const char* what, int index) { return what + std::to_string(index + 1); }

/// Returns true for currents without torque constants. Sizes are then in amperes.
bool per_current(const MonitorSetup& setup) {
    return setup.outputs.front().starts_with("i") &&
           std::ranges::all_of(setup.output_gain, [](double gain) { return gain == 1; });
}

template <int m>
void describe_payload(const Change<float, m>& change, const MonitorSetup& setup, NamedChange& named) {
    const double mass = static_cast<double>(change.size[0]);
    const Eigen::Vector3d moment(static_cast<double>(change.size[1]), static_cast<double>(change.size[2]),
                                 static_cast<double>(change.size[3]));
    const Eigen::Vector3d centre = setup.tip_placement.linear().transpose() * (moment / mass);
    named.where = "tool";
    named.parameters = {{"mass", per_current(setup) ? "kg·A/(N·m)" : "kg", mass},
                        {"com_x", "m", centre.x()},
                        {"com_y", "m", centre.y()},
                        {"com_z", "m", centre.z()}};
}

template <int m>
void describe_friction(const Change<float, m>& change, const MonitorSetup& setup, NamedChange& named) {
    const bool prismatic = setup.chain.joints[static_cast<std::size_t>(change.where)].prismatic;
    const auto unit = [&](const char* current, const char* torque) {
        return unit_at_joint(per_current(setup) ? current : torque, prismatic);
    };
    named.where = numbered("joint", change.where);
    named.parameters = {{"coulomb", unit("A", "N·m"), static_cast<double>(change.size[0])},
                        {"viscous", unit("A·s/rad", "N·m·s/rad"), static_cast<double>(change.size[1])}};
}

template <int m>
void describe_bias(const Change<float, m>& change, const MonitorSetup& setup, NamedChange& named) {
    named.where = setup.chain.sensor ? "ft_sensor" : numbered("joint", change.where);
    const std::vector<std::string> units = output_units(setup.outputs, &setup.chain);
    for (std::size_t k = 0; k < setup.outputs.size(); ++k) {
        const auto moved = static_cast<double>(change.bias[static_cast<int>(k)]);
        if (moved != 0) {
            named.parameters.push_back({setup.outputs[k], units[k], moved});
        }
    }
}

template <int m>
void describe_contact(const Change<float, m>& change, const MonitorSetup& setup, NamedChange& named) {
    if (change.where < 0) {
        named.where = setup.chain.sensor ? "ft_sensor" : "tool";
        for (int i = 0; i < 3; ++i) {
            named.parameters.push_back({std::string("force_") + "xyz"[i],
                                        per_current(setup) ? "N·A/(N·m)" : "N",
                                        static_cast<double>(change.size[i])});
        }
        return;
    }
    named.where = setup.chain.sensor ? "ft_sensor" : numbered("joint", change.where);
    const std::vector<std::string> units = output_units(setup.outputs, &setup.chain);
    named.parameters.push_back(
        {"mean", units[static_cast<std::size_t>(change.where)], static_cast<double>(change.size[0])});
}

template <int m>
void describe(const Change<float, m>& change, const MonitorSetup& setup, NamedChange& named) {
    const int joints = static_cast<int>(setup.chain.joints.size());
    switch (change.cause) {
    case Cause::payload:
        describe_payload(change, setup, named);
        break;
    case Cause::friction:
        describe_friction(change, setup, named);
        break;
    case Cause::bias:
        describe_bias(change, setup, named);
        break;
    case Cause::contact:
        describe_contact(change, setup, named);
        break;
    case Cause::frozen:
        named.where = change.where < joints ? numbered("encoder", change.where)
                                            : setup.outputs[static_cast<std::size_t>(change.where - joints)];
        break;
    case Cause::unknown:
        break;
    }
}

std::string shown_by(int channel, const MonitorSetup& setup) {
    const auto outputs = static_cast<int>(setup.outputs.size());
    if (channel < 0) {
        return "repeats";
    }
    return channel < outputs ? setup.outputs[static_cast<std::size_t>(channel)] : "all";
}

template <int m>
NamedChange in_words(const Change<float, m>& change, const MonitorSetup& setup) {
    NamedChange named;
    named.onset_ns = change.onset_ns;
    named.alarm_ns = change.alarm_ns;
    named.end_ns = change.end_ns;
    named.cause = change.cause;
    named.runner_up = change.runner_up;
    named.confidence = static_cast<double>(change.confidence);
    named.runner_up_confidence = static_cast<double>(change.runner_up_confidence);
    named.shown_by = shown_by(change.channel, setup);
    describe(change, setup, named);
    return named;
}

} // namespace

NamedChange named(const Change<float, dynamic>& change, const MonitorSetup& setup) {
    return in_words(change, setup);
}

NamedChange named(const Change<float, 6>& change, const MonitorSetup& setup) {
    return in_words(change, setup);
}

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
