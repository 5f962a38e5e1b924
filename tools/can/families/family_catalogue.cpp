// SPDX-License-Identifier: Apache-2.0
#include "tools/can/families/family_catalogue.hpp"

#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>

namespace dfdyn::tools {

/// A new family is one file in this folder, with one line here and one in its list below.
namespace families {

JointFamily icub_two_joint_board();
JointFamily icub_2foc();
JointFamily cia402();
JointFamily odrive();
JointFamily damiao();
JointFamily robstride();
JointFamily piper();
JointFamily cubemars();
JointFamily rmd();
JointFamily moteus();
JointFamily dbc_joints();

SensorFamily icub_strain();
SensorFamily robotous_rft();
SensorFamily ati_netcan();
SensorFamily dbc_sensor();

} // namespace families

const std::vector<JointFamily>& joint_families() {
    using namespace families;
    static const std::vector<JointFamily> catalogue{
        icub_two_joint_board(),
        icub_2foc(),
        cia402(),
        odrive(),
        damiao(),
        robstride(),
        piper(),
        cubemars(),
        rmd(),
        moteus(),
        dbc_joints(),
    };
    return catalogue;
}

const std::vector<SensorFamily>& sensor_families() {
    using namespace families;
    static const std::vector<SensorFamily> catalogue{
        icub_strain(),
        robotous_rft(),
        ati_netcan(),
        dbc_sensor(),
    };
    return catalogue;
}

namespace {

/// `expected`: another permitted value of `family`, or "".
template <class Family>
const Family& find_family(const JsonReader& reader, const std::vector<Family>& catalogue,
                          std::string expected) {
    const std::string name = reader.text("family");
    for (const Family& family : catalogue) {
        if (family.name == name) {
            return family;
        }
        expected += expected.empty() ? "" : &family == &catalogue.back() ? " or " : ", ";
        expected += family.name;
    }
    throw reader.error("family", expected, in_quotes(name));
}

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

std::string recognition_sentence(const JointFamily& family) {
    if (family.recognise == nullptr) {
        return {};
    }
    const std::string sentence = "\n`buscheck` recognises it on a bus without a description";
    return sentence +
           (family.no_draft.empty() ? ", and writes a draft of it"
                                    : ", without a draft: " + std::string(family.no_draft)) +
           ".\n";
}

} // namespace

const JointFamily& joint_family(const JsonReader& joints) {
    return find_family(joints, joint_families(), "");
}

const SensorFamily& sensor_family(const JsonReader& output) {
    return find_family(output, sensor_families(), "efforts");
}

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
        text += recognition_sentence(family);
    }
    for (const SensorFamily& family : sensor_families()) {
        text += section_of(family);
    }
    return text;
}

} // namespace dfdyn::tools
