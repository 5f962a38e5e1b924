// SPDX-License-Identifier: Apache-2.0
// A real UR5 by its motor currents, two runs as one: tests/data/ur5_kufieta/PROVENANCE.md. What is known of
// it without a doubt: its gears rub, neither friction nor a rotor is ever less than nothing, and where the
// robot's own controller believes its wrist to be heavy.
#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/joined_recording.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string>

namespace {

using namespace dfdyn::tools;

Diagnosis two_runs() {
    const std::filesystem::path folder = DFDYN_TEST_DATA_DIR "/ur5_kufieta";
    const std::array runs{folder / "Movement_No6_Acc_slow_Verify_Model.csv",
                          folder / "Movement_No7_Acc_slow_Verify_Model_short.csv"};
    ReadOptions columns;
    columns.joint_count = 6;
    columns.outputs = OutputKind::motor_current;
    columns.skip_bad_rows = true;
    DiagnosisOptions how;
    how.outputs = OutputKind::motor_current;
    how.measure = false;
    return diagnose(dfdyn::tests::ur5(), joined_recording(read_recordings(runs, columns)), how).diagnosis;
}

bool is_friction(const Finding& finding) {
    return finding.effect == "viscous_friction" || finding.effect == "coulomb_friction" ||
           finding.effect == "stribeck_friction" || finding.effect == "presliding_hysteresis" ||
           finding.effect == "load_dependent_friction";
}

double parameter(const Finding& finding, const std::string& name) {
    const auto found = std::ranges::find(finding.parameters, name, &FoundParameter::name);
    REQUIRE(found != finding.parameters.end());
    return found->value;
}

} // namespace

TEST_CASE(
    "of a real arm the friction of its joints and its wrist's centre of mass are named, and nothing that "
    "no machine has") {
    const Diagnosis diagnosis = two_runs();
    std::set<std::string> rubbing;
    for (const Finding& finding : diagnosis.findings) {
        INFO(finding.effect << " at " << finding.where);
        CHECK(finding.effect != "external_contact"); // nobody was near
        if (is_friction(finding)) {
            rubbing.insert(finding.where);
        }
        if (is_friction(finding) || finding.effect == "rotor_inertia") {
            CHECK(finding.parameters.front().value > 0);
        }
    }
    CHECK(rubbing.size() >= 5);
    REQUIRE(diagnosis.granted.size() >= 6);
    for (const GrantedQuantity& one : diagnosis.granted) {
        INFO(one.where);
        CHECK(one.parameter.low > 0);
    }

    // The robot's file has the wrist's centres of mass on its axes. By the controller's own rigid torques
    // (taur of the same recording, `dfdyn identify`), links 4 and 5 and 0.095 m times link 6's mass together
    // are 0.134 kg·m more along link 5's axis than the file says, and links 5 and 6 0.033 kg·m across it.
    const auto wrist = std::ranges::find_if(diagnosis.findings, [](const Finding& finding) {
        return finding.effect == "link_inertia_error" && finding.where == "link5";
    });
    REQUIRE(wrist != diagnosis.findings.end());
    CHECK(wrist->confidence >= 0.5);
    CHECK(parameter(*wrist, "delta_mass") == 0);
    const double mass = dfdyn::tests::ur5().joints[4].inertia[0];
    CHECK(mass * parameter(*wrist, "delta_com_z") == Approx(0.134).epsilon(0.25));
    CHECK(mass * parameter(*wrist, "delta_com_y") == Approx(0.033).epsilon(0.25));
}
