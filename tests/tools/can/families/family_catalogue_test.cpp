// SPDX-License-Identifier: Apache-2.0
#include "tools/can/families/family_catalogue.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/can/example_arms.hpp"
#include "tests/tools/support/name_literals.hpp"
#include "tools/can/arm/torque_frames.hpp"
#include "tools/can/description/bus_fields.hpp"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace family_catalogue_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Formats fields as in the documentation: `` `node`, `zero_rad` (0) ``.
std::string documented(const std::vector<FamilyField>& fields) {
    std::string text;
    for (const FamilyField& field : fields) {
        text += text.empty() ? "" : ", ";
        text.append("`").append(field.name).append("`");
        text.append(field.meaning.empty() ? "" : " ").append(field.meaning);
    }
    return text;
}

/// Rows of the table whose header begins with `header`.
std::string documented_rows(const std::string& header) {
    const std::string text = read_file(project / "docs/reference/can.md");
    const std::size_t begin = text.find('\n', text.find("| --- |", text.find(header))) + 1;
    return text.substr(begin, text.find("\n\n", begin) + 1 - begin);
}

TEST_CASE("no name of a device family is a literal outside its file") {
    std::set<std::string> names;
    for (const JointFamily& family : joint_families()) {
        names.emplace(family.name);
    }
    for (const SensorFamily& family : sensor_families()) {
        names.emplace(family.name);
    }
    std::set<std::string> seen;
    for (const auto& [file, found] : files_with_names(names)) {
        for (const std::string& name : found) {
            CAPTURE(file, name);
            CHECK(file == "tools/can/families/" + name + ".cpp");
            seen.insert(name);
        }
    }
    CHECK(seen == names);
}

TEST_CASE("the documentation's tables of families equal the catalogue") {
    std::string joints;
    for (const JointFamily& family : joint_families()) {
        joints.append("| `").append(family.name).append("` | ");
        joints += documented(family.board_fields) + " | ";
        joints += documented(family.fields) + (family.fields.empty() ? "|\n" : " |\n");
    }
    CHECK(documented_rows("| `joints.family` |") == joints);
    const std::string rows = documented_rows("| `output.family` |");
    std::string sensors = rows.substr(0, rows.find('\n') + 1); // sensor `efforts`: the joints' own efforts
    CHECK(sensors.starts_with("| `efforts` |"));
    for (const SensorFamily& family : sensor_families()) {
        sensors.append("| `").append(family.name).append("` | ");
        sensors += documented(family.fields) + " |\n";
    }
    CHECK(rows == sensors);
}

TEST_CASE("docs/reference/devices.md equals the text from the families' descriptors") {
    CHECK(read_file(project / "docs/reference/devices.md") == device_page());
    for (const JointFamily& family : joint_families()) {
        CAPTURE(family.name);
        CHECK_FALSE(family.devices.empty());
        CHECK((family.pitfalls.empty() || !family.sources.empty()));
    }
}

TEST_CASE("every DBC file belongs to a family") {
    std::set<std::string> expected;
    for (const JointFamily& family : joint_families()) {
        expected.emplace(family.dbc);
    }
    for (const SensorFamily& family : sensor_families()) {
        expected.emplace(family.dbc);
    }
    expected.erase("");
    std::set<std::string> found;
    for (const auto& file : std::filesystem::directory_iterator(project / "hal/dbc")) {
        found.insert(file.path().filename().string());
    }
    CHECK(found == expected);
}

TEST_CASE("arms of every family: buscheck finds no fault in the log that convert writes") {
    const std::vector<BusDescription> arms = example_arms();
    CHECK(arms.size() >= 14);
    for (const BusDescription& arm : arms) {
        CAPTURE(arm.joint_family->name, arm.output_range.size());
        CHECK(rules(arm, sound(arm, 1)) == Names{});
    }
}

TEST_CASE("arms of every family: a torque command is decoded as it was encoded") {
    for (const BusDescription& arm : example_arms()) {
        CAPTURE(arm.joint_family->name);
        TorqueFrames commands(arm);
        const std::vector<double> torque{1.5, -2.25};
        std::vector<double> taken(2);
        for (const dfdyn::hal::Frame& frame : commands.encode(torque)) {
            CHECK(commands.take(frame, taken));
        }
        const double half_count = arm.joint_family->name == "piper" ? 8.01 / 255 : 0.01; // commands of 8 bits
        CHECK(taken[0] == Approx(torque[0]).margin(half_count));
        CHECK(taken[1] == Approx(torque[1]).margin(half_count));
    }
}

} // namespace family_catalogue_test
