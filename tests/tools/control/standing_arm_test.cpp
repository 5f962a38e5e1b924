// SPDX-License-Identifier: Apache-2.0
// What the monitor of a loop says of an arm that stands between its motions.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/commands/robot_options.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <sstream>
#include <string>

namespace standing_arm_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// Postures within half of the motion's amplitude of `scenario`; between two of them a joint moves with
/// probability ½.
TaskModel rests(const Scenario& scenario, double dwell_s, std::mt19937_64& engine) {
    const auto& motion = std::get<MultisineTask>(scenario.task);
    std::uniform_real_distribution<double> share(-0.5, 0.5);
    PointToPointTask task{{motion.centre}, 2, dwell_s};
    for (int posture = 1; posture < 24; ++posture) {
        JointVector next = task.postures.back();
        for (Eigen::Index joint = 0; joint < next.size(); ++joint) {
            if (engine() % 2 == 0) {
                next[joint] = motion.centre[joint] + share(engine) * motion.amplitude[joint];
            }
        }
        task.postures.push_back(next);
    }
    return task;
}

/// What is said of iCub's arm, which carries a payload and learns, in lines.
std::string said(double dwell_s, double duration_s, std::mt19937_64& engine) {
    const std::string data = DFDYN_TEST_DATA_DIR;
    const std::string path = data + "/scenarios/icub_loop.json";
    const Robot robot = read_scenario_robot(data + "/robots/icub_right_arm/icub_right_arm.urdf", path);
    Scenario scenario = read_scenario(path, robot);
    scenario.task = rests(scenario, dwell_s, engine);
    scenario.payloads.resize(1);
    LoopModel model{unlearned_model(engine, 4, 0.008, {"tau1", "tau2", "tau3", "tau4"}, 30), "model", true};
    model.model.forgetting_factor = 0.999; // a memory of 8 s
    ClosedLoop loop(robot, scenario, "test", &model);
    loop.run_to(duration_s, [](const ClosedLoopInstant&) {});
    CHECK(loop.loop().state() == LoopState::running);
    std::ostringstream lines;
    print_changes(lines, loop.loop().feed_forward().learned()->changes());
    return lines.str();
}

TEST_CASE("of an arm that stands for 20 s between its motions no change is announced") {
    DFDYN_SEEDED_ENGINE(engine);
    CHECK(said(20, 72, engine) == "");
}

TEST_CASE("of an arm that stands for minutes no change is announced in half an hour", "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    const double dwell_s = GENERATE(5., 60., 300.);
    CAPTURE(dwell_s);
    CHECK(said(dwell_s, 1800, engine) == "");
}

} // namespace standing_arm_test
