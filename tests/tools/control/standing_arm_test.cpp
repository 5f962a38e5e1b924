// SPDX-License-Identifier: Apache-2.0
// False alarms of the monitor in a loop whose arm rests between its motions.
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/tools/support/append_row.hpp"
#include "tools/commands/options/robot_options.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/model_training.hpp"
#include "tools/training/training_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string>

namespace standing_arm_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

/// An arm of tests/data/scenarios, without the payload that is attached later.
struct LoopArm {
    Robot robot;
    Scenario scenario;

    LoopArm(const std::string& name, const std::string& urdf) {
        const std::string data = DFDYN_TEST_DATA_DIR;
        const std::string path = data + "/scenarios/" + name + "_loop.json";
        robot = read_scenario_robot(data + "/robots/" + urdf, path);
        scenario = read_scenario(path, robot);
        scenario.payloads.resize(1);
    }
};

LoopArm ur5() { return {"ur5", "ur5/ur5_robot.urdf"}; }
LoopArm icub() { return {"icub", "icub_right_arm/icub_right_arm.urdf"}; }

/// Random postures within half of the amplitude of the scenario's motion. Between two of them each joint
/// moves with probability ½, in 2 s, and then rests for `standstill_s`.
TaskModel standstills(const Scenario& scenario, double standstill_s, std::mt19937_64& engine) {
    const auto& motion = std::get<MultisineTask>(scenario.task);
    std::uniform_real_distribution<double> share(-0.5, 0.5);
    PointToPointTask task{{motion.centre}, 2, standstill_s};
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

std::vector<std::string> torques(const LoopArm& arm) {
    return output_names(OutputKind::joint_torque, arm.robot.joints.size());
}

/// Returns the changes that the loop's monitor reports, one line each. The loop begins with an untrained
/// model.
std::vector<std::string> reports(LoopArm arm, const LoopModel& model, double standstill_s, double duration_s,
                                 std::mt19937_64& engine) {
    arm.scenario.seed = engine();
    arm.scenario.task = standstills(arm.scenario, standstill_s, engine);
    ClosedLoop loop(arm.robot, arm.scenario, "test", &model);
    loop.run_to(duration_s, [](const ClosedLoopInstant&) {});
    CHECK(loop.loop().state() == LoopState::running);
    std::stringstream text;
    print_changes(text, loop.loop().feed_forward().learned()->changes("learned"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) {
        lines.push_back(line);
    }
    return lines;
}

/// A memory of 8 s, so that most of the past is forgotten in a standstill.
constexpr double forgetting = 0.999;

TEST_CASE("an arm that rests for 10 s between its motions raises no alarm") {
    DFDYN_SEEDED_ENGINE(engine);
    LoopArm arm = icub();
    LoopModel model{unlearned_model(engine, 4, 0.008, torques(arm), 30), "model", true};
    model.model.forgetting_factor = forgetting;
    const std::vector<std::string> lines = reports(arm, model, 10, 170, engine);
    CAPTURE(lines);
    CHECK(lines.empty());
}

/// Records positions and torques of half a minute of the scenario's motion with the nominal rigid body,
/// without payload, at the rate of the recordings.
Recording commissioning(LoopArm arm) {
    arm.scenario.payloads.clear();
    arm.scenario.seed = 1;
    Recording recording;
    recording.source = "commissioning";
    recording.position.names = joint_names("q", arm.robot.joints.size());
    recording.output.names = torques(arm);
    LoopLimits limits;
    limits.observer_bandwidth = {0};
    ClosedLoop loop(arm.robot, arm.scenario, "test", nullptr, nullptr, limits);
    loop.run_to(30, [&](const ClosedLoopInstant& instant) {
        const auto row = static_cast<double>(recording.row_count()) / arm.scenario.recording.rate_hz;
        if (instant.time_s < row - 1e-6) {
            return;
        }
        append_row(recording, row, *instant.measured.position, *instant.measured.torque);
    });
    return recording;
}

/// A model trained like the one of tools/loop_demo.sh.
LoopModel commissioned(const LoopArm& arm, const Structure* kind) {
    ModelTraining training;
    training.options.model = kind;
    training.options.feature_count = 60;
    training.options.forgetting_factor = forgetting;
    training.options.likelihood_rows = 500;
    training.options.starts = 4;
    training.options.refinement_evaluations = 10;
    training.physics = RobotPhysics{
        arm.robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"}, 0.05, {}};
    const std::vector<Recording> recordings{commissioning(arm)};
    return {train_model(prepare_training(recordings, training), OutputKind::joint_torque, training, {}).model,
            "model", true};
}

/// Checks the false alarms in ten hours: both models, standstills of 5 s to 5 minutes, 75 minutes each.
void check_ten_hours(const LoopArm& arm, std::mt19937_64& engine) {
    constexpr std::array standstills_s{5., 20., 60., 300.};
    constexpr double run_s = 4500;
    std::size_t alarms = 0;
    for (const Structure* const kind : {&structures::P, &structures::SPK}) {
        const LoopModel model = commissioned(arm, kind);
        for (const double standstill_s : standstills_s) {
            const std::vector<std::string> lines = reports(arm, model, standstill_s, run_s, engine);
            alarms += lines.size();
            std::ostringstream text;
            text << kind->name << ", standstills of " << standstill_s << " s: " << lines.size()
                 << " false alarms in " << run_s / 3600 << " h";
            for (const std::string& line : lines) {
                text << '\n' << line;
            }
            WARN(text.str());
        }
    }
    CHECK(alarms <= 2); // the documentation states one alarm in 5 h
}

TEST_CASE("a UR5 that rests for seconds to minutes raises at most two false alarms in ten hours", "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    check_ten_hours(ur5(), engine);
}

TEST_CASE("an iCub's arm that rests for seconds to minutes raises at most two false alarms in ten hours",
          "[.long]") {
    DFDYN_SEEDED_ENGINE(engine);
    check_ten_hours(icub(), engine);
}

} // namespace standing_arm_test
