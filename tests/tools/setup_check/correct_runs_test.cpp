// SPDX-License-Identifier: Apache-2.0
// Correct recordings whose motion, load or friction looks like a mistake are accepted.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/simulated_runs.hpp"

#include <random>
#include <string>

namespace correct_runs_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Checks that runs of a kind are accepted, without and with the robot.
void check_accepted(const Robot& robot, const RunKind& kind, int runs, std::mt19937_64& engine) {
    for (int run = 0; run < runs; ++run) {
        CAPTURE(run, robot.name, kind.describe());
        const Recording recording = simulated_run(robot, kind, engine);
        for (const SetupQuestion& question : {SetupQuestion{kind.outputs}, {kind.outputs, &robot}}) {
            std::string mistakes;
            for (const SetupFinding& finding : check_setup(recording, question)) {
                mistakes += finding.severity == Severity::mistake ? finding.text + "\n" : "";
            }
            CHECK(mistakes == "");
        }
    }
}

TEST_CASE("moves between two postures are accepted whatever torque friction holds at rest") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.friction = 0.8;
    kind.noise = 0.01;
    kind.rest_s = 2;
    kind.postures = 2;
    check_accepted(ur5(), kind, 10, engine);
}

TEST_CASE("slow joints without gravity do not look exchanged") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.speed = 0.06;
    kind.duration_s = 15;
    kind.position_noise = 1e-4;
    kind.friction = GENERATE(0.0, 0.6);
    kind.moving = {true, false, true, false, true, true};
    check_accepted(ur5(), kind, 10, engine);
}

TEST_CASE("a heavy tool on wrist joints that move alone is no other unit") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.payload_kg = 5.5;
    kind.speed = 0.5;
    kind.moving = {false, false, false, true, true, false};
    check_accepted(tx40(), kind, 5, engine);
}

TEST_CASE("a tool far from the tip of a fast light arm does not look like another robot") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.payload_kg = 2.5;
    kind.speed = GENERATE(1.0, 2.9);
    check_accepted(icub_right_arm(), kind, 20, engine);
}

TEST_CASE("the inertia of an arm without friction does not look like reversed friction") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.speed = 0.35;
    kind.duration_s = 16;
    check_accepted(planar_arm(0), kind, 200, engine);
}

} // namespace correct_runs_test
