// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/support/append_row.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/training/model_training.hpp"

#include <cmath>
#include <vector>

namespace dfdyn::tests {

/// Records half a minute of the arm without payload on another motion with the nominal rigid body, at one row
/// per 8 ms.
inline tools::Recording commissioning(const tools::Robot& robot, tools::Scenario scenario) {
    scenario.payloads.clear();
    scenario.seed += 100;
    const auto row_ticks = static_cast<int>(std::lround(0.008 * scenario.controller.rate_hz));
    tools::Recording recording;
    recording.source = "commissioning";
    recording.position.names = tools::joint_names("q", robot.joints.size());
    recording.output.names = tools::output_names(tools::OutputKind::joint_torque, robot.joints.size());
    tools::ClosedLoop loop(robot, scenario, "scenario", nullptr);
    int tick = 0;
    loop.run_to(30, [&](const tools::ClosedLoopInstant& instant) {
        if (tick++ % row_ticks != 0) {
            return;
        }
        append_row(recording, instant.time_s, *instant.measured.position, *instant.measured.torque);
    });
    return recording;
}

/// Returns a model of the joints' torques that has learned nothing. Its hyperparameters are trained on the
/// `commissioning` of the arm. `features`: of a model that has them.
inline tools::LoopModel commissioned_model(const tools::Robot& robot, const tools::Scenario& scenario,
                                           const tools::Structure& structure = tools::structures::SPK,
                                           int features = 30) {
    tools::ModelTraining training;
    tools::TrainingOptions& options = training.options;
    options.model = &structure;
    options.feature_count = features;
    options.likelihood_rows = 200;
    options.starts = 2;
    options.refinement_evaluations = 0;
    options.forgetting_factor = 0.999;
    training.physics = tools::RobotPhysics{
        robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"}, 0.05, {}};
    const std::vector<tools::Recording> recordings{commissioning(robot, scenario)};
    tools::LoopModel model{tools::train_model(tools::prepare_training(recordings, training),
                                              tools::OutputKind::joint_torque, training, {})
                               .model,
                           "model", true};
    tools::calibrate_innovation_limit(model.model, recordings);
    return model;
}

} // namespace dfdyn::tests
