// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/frozen_estimator.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/replay/contacts/contact_limits.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/replay/replay.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/training/model_training.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

inline tools::Robot contact_robot(const std::string& urdf, const std::string& tip) {
    tools::ReadRobotOptions options;
    options.tip = tip;
    return tools::read_robot(std::string(DFDYN_TEST_DATA_DIR) + "/robots/" + urdf, options);
}

/// Rigid body and friction with the limits of contacts, as `dfdyn train --starts` computes them.
inline tools::TrainedModel contact_model(std::span<const tools::Recording> recordings,
                                         const tools::Robot& robot, tools::OutputKind outputs, int starts) {
    tools::ModelTraining training;
    training.options.model = &tools::structures::P;
    training.options.input = tools::InputKind::DFR;
    training.options.lags = 10;
    training.options.likelihood_rows = 600;
    training.options.starts = starts;
    training.physics = tools::RobotPhysics{
        robot, {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"}, std::nullopt, {}};
    tools::TrainedModel model =
        train_model(prepare_training(recordings, training), outputs, training, {}).model;
    calibrate_innovation_limit(model, recordings);
    model.contact = measure_contact_limits(model, recordings);
    return model;
}

/// Returns the starts of the contacts that are detected in a recording, in its own time, s.
inline std::vector<double> contact_times(const tools::TrainedModel& model, const tools::ContactModel& contact,
                                         const tools::Recording& recording, bool learning) {
    auto estimator = make_estimator(model, false);
    const auto detector =
        with_contacts(learning ? std::move(estimator) : frozen(std::move(estimator)), {contact});
    const auto replayed = replay(*detector, std::span(&model, 1), recording, 0, [](std::size_t) {});
    std::vector<double> starts;
    for (const tools::DetectedContact& one : detector->take_contacts()) {
        starts.push_back(replayed.clock_origin_s + 1e-9 * static_cast<double>(one.start_ns));
    }
    return starts;
}

} // namespace dfdyn::tests
