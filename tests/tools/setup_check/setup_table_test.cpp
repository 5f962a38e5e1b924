// SPDX-License-Identifier: Apache-2.0
// The table of docs/guide/setup-check.md: mistakes by recordings, and correct recordings that are rejected.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/mistakes.hpp"

#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

namespace setup_table_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

const std::filesystem::path data = DFDYN_TEST_DATA_DIR;

struct Family {
    std::string name, folder;
    OutputKind outputs;
    std::string urdf, base, tip;
};

/// Counts of one cell over recordings and their parts.
struct Cell {
    int refused = 0, refused_as_other = 0, warned = 0, passed = 0;

    std::string text() const {
        std::string result = std::to_string(refused);
        result += " / " + std::to_string(refused_as_other);
        result += " / " + std::to_string(warned);
        return result + " / " + std::to_string(passed);
    }
};

void count(Cell& cell, const SetupFindings& findings, SetupFault fault) {
    bool named = false;
    for (const SetupFinding& finding : findings) {
        named = named || (finding.severity == Severity::mistake && finding.fault == fault);
    }
    ++(named                   ? cell.refused
       : any_mistake(findings) ? cell.refused_as_other
       : !findings.empty()     ? cell.warned
                               : cell.passed);
}

std::vector<Recording> recordings_in(const Family& family) {
    ReadOptions options;
    options.outputs = family.outputs;
    std::vector<Recording> recordings;
    for (const auto& entry : std::filesystem::directory_iterator(data / family.folder)) {
        if (entry.path().extension() == ".csv") {
            recordings.push_back(read_recording(entry.path(), options));
        }
    }
    return recordings;
}

/// Prints one row per mistake, after the correct recordings, without and with the robot.
void print_family(const Family& family) {
    ReadRobotOptions chain;
    chain.base = family.base;
    chain.tip = family.tip;
    const Robot robot = read_robot(data / family.urdf, chain);
    const std::vector<Recording> recordings = recordings_in(family);
    std::vector<Mistake> mistakes{{"none", SetupFault::gravity, [](Recording&) {}}};
    for (Mistake& mistake : classic_mistakes(robot.joints.size(), family.outputs)) {
        mistakes.push_back(std::move(mistake));
    }
    std::cout << "\n**" << family.name << "**\n\n| mistake | without a robot | with the robot |\n"
              << "| --- | ---: | ---: |\n";
    for (const Mistake& mistake : mistakes) {
        Cell alone;
        Cell with_robot;
        for (const Recording& recording : recordings) {
            for (const Cut& one : cuts_of(recording)) {
                Recording wrong = one.recording;
                mistake.make(wrong);
                count(alone, check_setup(wrong, {family.outputs}), mistake.fault);
                count(with_robot, check_setup(wrong, {family.outputs, &robot}), mistake.fault);
            }
        }
        std::cout << "| " << mistake.name << " | " << alone.text() << " | " << with_robot.text() << " |"
                  << std::endl;
        if (mistake.name == "none") {
            CHECK(alone.refused + alone.refused_as_other == 0);
            CHECK(with_robot.refused + with_robot.refused_as_other == 0);
        }
    }
}

TEST_CASE("no correct recording is rejected in the table of mistakes by recordings", "[.long][setup-table]") {
    print_family({"UR5", "ur5_kufieta", OutputKind::motor_current, "robots/ur5/ur5_robot.urdf", "base_link",
                  "ee_link"});
    print_family({"UR5 of another laboratory", "ur5_nist", OutputKind::motor_current,
                  "robots/ur5/ur5_robot.urdf", "base_link", "ee_link"});
    print_family({"Stäubli TX40", "tx40_figaroh", OutputKind::joint_torque, "robots/tx40/tx40.urdf",
                  "base_link", "tool0"});
    print_family(
        {"XL330 servo", "xl330_bam", OutputKind::motor_current, "xl330_bam/pendulum.urdf", "base", "arm"});
}

} // namespace setup_table_test
