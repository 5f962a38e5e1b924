// SPDX-License-Identifier: Apache-2.0
// A loop that learns the arm it moves, over the frames of its devices: tracking against the nominal rigid
// body's.
#include "tests/support/catch.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/control/tracking_report.hpp"
#include "tools/evaluation/contradiction.hpp"
#include "tools/physics/model_training.hpp"
#include "tools/robot/read_robot.hpp"

#include <cmath>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace dfdyn::tools;

constexpr int knot_ticks = 8;

struct Setting {
    Robot robot;
    Scenario scenario;
    BusDescription bus;
};

Setting setting(const std::string& robot, const std::string& tip, const std::string& name) {
    const std::string data = DFDYN_TEST_DATA_DIR;
    ReadRobotOptions options;
    options.tip = tip;
    Setting result{read_robot(data + "/robots/" + robot, options), {}, {}};
    result.scenario = read_scenario(data + "/scenarios/" + name, result.robot);
    result.bus = read_bus_description(data + "/can/" + name);
    return result;
}

/// Half a minute of the arm without payload, on another motion, under the nominal rigid body: for the
/// hyperparameters.
Recording commissioning(const Setting& setting) {
    Scenario scenario = setting.scenario;
    scenario.payloads.clear();
    scenario.seed += 100;
    const std::size_t joints = setting.robot.joints.size();
    Recording recording;
    recording.source = "commissioning";
    recording.position.names = joint_names("q", joints);
    recording.output.names = output_names(OutputKind::joint_torque, joints);
    ClosedLoop loop(setting.robot, scenario, "scenario", nullptr);
    int tick = 0;
    loop.run_to(30, [&](const ClosedLoopInstant& instant) {
        if (tick++ % knot_ticks != 0) {
            return;
        }
        recording.gap_before.push_back(recording.time_s.empty());
        recording.time_s.push_back(instant.time_s);
        recording.time_ns.push_back(std::llround(instant.time_s * 1e9));
        recording.position.values.insert(recording.position.values.end(), instant.position.begin(),
                                         instant.position.end());
        recording.output.values.insert(recording.output.values.end(), instant.torque.begin(),
                                       instant.torque.end());
    });
    return recording;
}

LoopModel trained(const Setting& setting) {
    ModelTraining training;
    TrainingOptions& options = training.options;
    options.model = ModelClass::SPK;
    options.feature_count = 60;
    options.likelihood_rows = 300;
    options.starts = 1;
    options.evaluations_per_start = 60;
    options.refinement_evaluations = 0;
    options.forgetting_factor = 0.9995;
    options.physics.own_motion = true;
    training.physics = RobotPhysics{
        setting.robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"}, 0.05, {}};
    const std::vector<Recording> recordings{commissioning(setting)};
    LoopModel model{
        train_model(prepare_training(recordings, training), OutputKind::joint_torque, training, {}).model,
        "model", true};
    calibrate_innovation_limit(model.model, recordings);
    return model;
}

TrackingRun tracked(const Setting& setting, const LoopModel* model, double duration_s) {
    ClosedLoop loop(setting.robot, setting.scenario, "scenario", model, &setting.bus);
    Tracking tracking;
    loop.run_to(duration_s, [&](const ClosedLoopInstant& instant) {
        tracking.add(instant.time_s, instant.error, loop.loop().feed_forward().learned_share());
    });
    CHECK(loop.loop().state() == LoopState::running);
    return {model != nullptr ? "learned" : "nominal", tracking.windows()};
}

} // namespace

TEST_CASE("a loop that begins with nothing learned tracks three times better after a minute, and never worse",
          "[.long]") {
    Setting arm = GENERATE(0, 1) == 0
                      ? setting("ur5/ur5_robot.urdf", "ee_link", "ur5_loop.json")
                      : setting("icub_right_arm/icub_right_arm.urdf", "r_hand", "icub_loop.json");
    const LoopModel model = trained(arm);
    Payload second = arm.scenario.payloads.front();
    second.attached_s = 65; // in mid-motion, as heavy as the first
    arm.scenario.payloads.push_back(second);
    const std::vector<TrackingRun> runs{tracked(arm, nullptr, 95.001), tracked(arm, &model, 95.001)};
    print_tracking(std::cout, runs);
    for (std::size_t window = 0; window < runs[0].windows.size(); ++window) {
        const TrackingWindow& nominal = runs[0].windows[window];
        const TrackingWindow& learned = runs[1].windows.at(window);
        CAPTURE(arm.robot.name, nominal.start_s, nominal.all, learned.all);
        CHECK(learned.all <= nominal.all);
        const bool settled = nominal.start_s == 60 || nominal.start_s >= 85;
        CHECK((!settled || learned.all < nominal.all / 3));
    }
}
