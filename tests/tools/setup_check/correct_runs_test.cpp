// SPDX-License-Identifier: Apache-2.0
// Correct recordings whose motion, load or friction looks like a mistake are accepted, and similar wrong ones
// refused.
#include "tools/setup_check/setup_check.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tests/tools/setup_check/mistakes.hpp"
#include "tests/tools/setup_check/simulated_runs.hpp"
#include "tools/setup_check/friction_sign.hpp"
#include "tools/setup_check/rigid_body/rigid_comparison.hpp"

#include <random>
#include <string>
#include <utility>
#include <vector>

namespace correct_runs_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Checks that runs of a kind are accepted, without and with the robot.
void check_accepted(const Robot& robot, const RunKind& kind, int runs, std::mt19937_64& engine) {
    for (int run = 0; run < runs; ++run) {
        CAPTURE(run, robot.name, kind.describe());
        const Recording recording = simulated_run(robot, kind, engine);
        CHECK(mistakes_in(recording, {kind.outputs}) == "");
        CHECK(mistakes_in(recording, {kind.outputs, &robot}) == "");
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

TEST_CASE("slow joints without gravity are not refused as exchanged") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.speed = 0.06;
    kind.duration_s = 15;
    kind.position_noise = 1e-4;
    kind.friction = GENERATE(0.0, 0.6);
    kind.moving = {true, false, true, false, true, true};
    check_accepted(ur5(), kind, 10, engine);
}

TEST_CASE("fast joints without gravity are refused as exchanged however long the run is") {
    DFDYN_SEEDED_ENGINE(engine);
    const Robot robot = planar_arm(0);
    RunKind kind;
    kind.speed = 2;
    kind.duration_s = GENERATE(30, 600);
    Recording recording = simulated_run(robot, kind, engine);
    change_outputs(recording, [](double* torque) { std::swap(torque[0], torque[1]); });
    CHECK_THAT(mistakes_in(recording, {kind.outputs, &robot}),
               Catch::Matchers::ContainsSubstring("look exchanged"));
}

TEST_CASE("an axis that rounded angles of the robot's file tilt has no gravity") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double tilt = 3.7e-6; // of an angle written as 1.5708
    Robot robot = planar_arm(9.81 * tilt);
    robot.gravity.z() = -9.81;
    const auto checked = checked_motion(simulated_run(robot, {}, engine));
    REQUIRE(checked);
    CHECK(rigid_parts(robot, OutputKind::joint_torque, checked->recorded.motion).gravity.isZero(0));
}

TEST_CASE("a heavy tool on wrist joints that move alone is not refused as another unit") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.payload_kg = 5.5;
    kind.speed = 0.5;
    kind.moving = {false, false, false, true, true, false};
    check_accepted(tx40(), kind, 5, engine);
}

TEST_CASE("a tool far from the tip of a fast light arm is not refused as another robot") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.payload_kg = 2.5;
    kind.speed = GENERATE(1.0, 2.9);
    check_accepted(icub_right_arm(), kind, 20, engine);
}

TEST_CASE("an arm without friction that repeats three moves has no certain sign of friction") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Robot> robots{ur5(), tx40(), icub_right_arm()};
    for (int run = 0; run < 600; ++run) {
        const Robot& robot = robots[engine() % robots.size()];
        RunKind kind = random_kind(robot, OutputKind::joint_torque, engine);
        kind.friction = 0;
        kind.rate_hz = 60;
        kind.duration_s = 20;
        kind.rest_s = 1;
        kind.postures = 3;
        CAPTURE(run, robot.name, kind.describe());
        const auto checked = checked_motion(simulated_run(robot, kind, engine));
        REQUIRE(checked);
        for (Eigen::Index joint = 0; joint < checked->recorded.outputs.cols(); ++joint) {
            CHECK_FALSE(friction_sign(checked->recorded, joint).certain);
        }
    }
}

TEST_CASE("the inertia of an arm without friction is not refused as reversed friction") {
    DFDYN_SEEDED_ENGINE(engine);
    RunKind kind;
    kind.speed = 0.35;
    kind.duration_s = 16;
    check_accepted(planar_arm(0), kind, 200, engine);
}

} // namespace correct_runs_test
