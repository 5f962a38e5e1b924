// SPDX-License-Identifier: Apache-2.0
#include "tools/can/families/device_page.hpp"

#include "tools/base/text/number.hpp"
#include "tools/can/families/family_catalogue.hpp"

namespace dfdyn::tools {

namespace {

std::string maximum_text(const MotorType& type, std::size_t i) {
    const std::string one = rounded_text(type.maxima.at(i));
    return type.agrees(i) ? one : one + " or " + rounded_text(type.others.at(i));
}

std::string types_table(const std::vector<MotorType>& types) {
    std::string text = "\n| `motor` | position_max (rad) | velocity_max (rad/s) | torque_max (N·m) |\n"
                       "| --- | --- | --- | --- |\n";
    for (const MotorType& type : types) {
        text.append("| ").append(type.name);
        for (std::size_t i = 0; i < type.maxima.size(); ++i) {
            text += " | " + maximum_text(type, i);
        }
        text += " |\n";
    }
    return text;
}

std::string list_of(const char* title, const std::vector<std::string_view>& items) {
    if (items.empty()) {
        return {};
    }
    std::string text = std::string("\n") + title + "\n\n";
    for (const std::string_view item : items) {
        text.append("- ").append(item).append("\n");
    }
    return text;
}

/// `Family`: JointFamily or SensorFamily.
template <class Family>
std::string section_of(const Family& family) {
    std::string text = "\n## `" + std::string(family.name) + "`\n\n" + std::string(family.devices) + ".";
    text += family.dbc.empty() ? "\n" : " DBC file: `hal/dbc/" + std::string(family.dbc) + "`.\n";
    return text;
}

} // namespace

std::string device_page() {
    std::string text =
        "# Devices\n\nWritten by `dfdyn buscheck --devices` from the families' descriptors. The fields of "
        "bus.json are in [can.md](can.md).\nTwo numbers of one maximum: libraries or documents "
        "disagree; the description of a bus must have it.\n";
    for (const JointFamily& family : joint_families()) {
        text += section_of(family);
        text += family.types.empty() ? "" : types_table(family.types);
        text += list_of("Common decoding errors:", family.pitfalls);
        text += list_of("Sources:", family.sources);
        text +=
            family.recognise == nullptr ? "" : "\n`buscheck` recognises it on a bus without a description.\n";
    }
    for (const SensorFamily& family : sensor_families()) {
        text += section_of(family);
    }
    return text;
}

} // namespace dfdyn::tools
