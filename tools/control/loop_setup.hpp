// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/control_loop.hpp"
#include "tools/simulation/scenario.hpp"

#include <memory>
#include <string>

namespace dfdyn::tools {

/// A learned model for the loop to use.
struct LoopModel {
    TrainedModel model;
    std::string source;      ///< for messages
    bool from_prior = false; ///< learn from nothing
};

/// The loop that a scenario describes: task, gains and rate of its `controller` (of kind feed_forward),
/// filter of its `derivatives`, torque limit of its `actuators` or else of the robot. The nominal rigid body
/// is `robot` with the scenario's rotors. `learned`: none for nominal feed-forward alone. `delay_ticks`: see
/// LoopConfig. Throws InputError, naming `source` or the model, for what does not fit.
std::unique_ptr<ControlLoop> make_control_loop(const Robot& robot, const Scenario& scenario,
                                               const std::string& source, const LoopModel* learned,
                                               int delay_ticks = 0);

} // namespace dfdyn::tools
