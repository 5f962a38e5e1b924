// SPDX-License-Identifier: Apache-2.0
// A Stäubli TX40 whose owner documents its friction (tests/data/tx40_figaroh/PROVENANCE.md).
#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace {

using namespace dfdyn::tools;

/// Documented friction of a joint. Joints 5 and 6 are not comparable, because their motors are coupled.
struct Documented {
    double viscous, dry;
};
constexpr std::array<Documented, 4> documented_friction{
    {{8.05, 7.14}, {5.53, 8.26}, {1.97, 6.34}, {1.11, 2.48}}};
/// The coupling adds 0.0096 kg·m² to the rotor of joint 5.
constexpr std::array<double, 6> documented_rotors{0.362, 0.362, 0.0988, 0.0313, 0.0468, 0.0105};

Diagnosis diagnosis_of_tx40() {
    const std::string data = DFDYN_TEST_DATA_DIR;
    ReadOptions columns;
    columns.joint_count = 6;
    columns.outputs = OutputKind::joint_torque;
    DiagnosisOptions how;
    how.measure = false;
    return diagnose(dfdyn::tests::tx40(), read_recording(data + "/tx40_figaroh/tx40_5kHz.csv", columns), how)
        .diagnosis;
}

/// Mean of the parameters of a finding; 0 if there is no such finding.
double value_of(const Diagnosis& diagnosis, const std::string& effect, const std::string& where) {
    const auto found = std::ranges::find_if(diagnosis.findings, [&](const Finding& finding) {
        return finding.effect == effect && finding.where == where;
    });
    if (found == diagnosis.findings.end()) {
        return 0;
    }
    double sum = 0; // dry friction may have a level for each direction
    for (const FoundParameter& parameter : found->parameters) {
        sum += parameter.value / static_cast<double>(found->parameters.size());
    }
    return sum;
}

} // namespace

TEST_CASE("the friction found in seven seconds of a real TX40 agrees with its owner's values") {
    const Diagnosis diagnosis = diagnosis_of_tx40();
    for (std::size_t i = 0; i < documented_friction.size(); ++i) {
        const std::string where = "joint" + std::to_string(i + 1);
        const Documented& expected = documented_friction[i];
        CAPTURE(where);
        CHECK(value_of(diagnosis, "viscous_friction", where) == Approx(expected.viscous).epsilon(0.2));
        CHECK(value_of(diagnosis, "coulomb_friction", where) == Approx(expected.dry).epsilon(0.2));
    }
    int rotors = 0;
    for (std::size_t i = 0; i < documented_rotors.size(); ++i) {
        const double rotor = value_of(diagnosis, "rotor_inertia", "joint" + std::to_string(i + 1));
        rotors += std::abs(rotor - documented_rotors[i]) < 0.5 * documented_rotors[i] ? 1 : 0;
    }
    CHECK(rotors >= 4);
    const auto wrist = std::ranges::find(diagnosis.unexplained, 4, &Unexplained::output);
    REQUIRE(wrist != diagnosis.unexplained.end());
    CHECK(std::ranges::find(wrist->depends_on, "qd6") != wrist->depends_on.end());
}
