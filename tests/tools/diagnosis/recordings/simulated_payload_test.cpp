// SPDX-License-Identifier: Apache-2.0
// A light arm with a payload of 40 % of its last link's mass, bristle friction and rotors. The simulator
// integrates the arm, independently of the fitted columns.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/diagnosis/finding_parameter.hpp"
#include "tests/tools/diagnosis/recordings/simulated_recording.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <algorithm>
#include <cmath>

namespace simulated_payload_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Returns whether the finding is a likely error of a link or of the arm's mounting.
bool is_error_of_arm(const Finding& finding) {
    return finding.confidence >= 0.5 &&
           (finding.effect == "link_inertia_error" || finding.effect == "link_rotational_inertia_error" ||
            finding.effect == "gravity_tilt");
}

/// Returns whether the payload is named with its mass within 10 % and its centre of mass within 3 cm, without
/// an error of the arm.
bool is_named(const Diagnosis& diagnosis, const Payload& truth) {
    const auto payload = std::ranges::find(diagnosis.findings, "payload", &Finding::effect);
    if (payload == diagnosis.findings.end()) {
        return false;
    }
    const Eigen::Vector3d centre(parameter(*payload, "com_x"), parameter(*payload, "com_y"),
                                 parameter(*payload, "com_z"));
    const double mass = parameter(*payload, "mass");
    return payload->confidence >= 0.9 && std::ranges::none_of(diagnosis.findings, is_error_of_arm) &&
           std::abs(mass - truth.mass) < 0.1 * truth.mass && (centre - truth.centre).norm() < 0.03;
}

TEST_CASE("a strong payload of a light arm is named with its mass and place in most motions, without errors "
          "of the arm") {
    INFO("DFDYN_TEST_SEED=" << seed());
    const Robot robot = small_arm();
    Scenario scenario = read_scenario(DFDYN_TEST_DATA_DIR "/scenarios/small_arm.json", robot);
    scenario.recording.samples = 3000;
    const Payload truth{0, 0.5, {0, 0, 0.1}};
    scenario.payloads = {truth};
    DiagnosisOptions how;
    how.outputs = OutputKind::joint_torque;
    int named = 0;
    for (const std::uint64_t motion : {1, 2, 3, 4, 5, 6}) {
        scenario.seed = 100 * seed() + motion; // another motion and other noise
        const Diagnosis diagnosis =
            diagnose(robot, simulated_recording(robot, scenario, "payload.csv"), how).diagnosis;
        named += is_named(diagnosis, truth) ? 1 : 0;
    }
    CHECK(named >= 4); // 32 of the 36 motions of seeds 1 to 6
}

} // namespace simulated_payload_test
