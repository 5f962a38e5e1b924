// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"
#include "tools/control/loop/control_loop.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A learned model for the loop to use.
struct LoopModel {
    TrainedModel model;
    std::string source;               ///< for messages
    bool from_prior = false;          ///< learn from nothing
    std::vector<std::byte> learned{}; ///< to go on from: a LearnedFeedForward::snapshot; empty: none
    std::string learned_source{};     ///< for messages
};

/// Limits that a user sets; empty or none: the defaults of `default_limits`. A single value is that of all
/// joints.
struct LoopLimits {
    std::vector<double> following_error; ///< rad, m
    std::vector<double> speed;           ///< rad/s, m/s
    StopMode mode = StopMode::hold;
    std::vector<double> observer_bandwidth{}; ///< rad/s; 0: no observer
    std::vector<double> learned_limit{}; ///< shares of the torque limit that is added to the rigid body's
    FindingActions actions{};
};

/// Limits of a loop with these gains and torque limits:
/// - following error: the position gain times it is 0.8 of the torque limit; at most 0.5 rad or 0.1 m;
/// - speed: the robot's own; none where it has none, or one of more than 100 rad/s or m/s;
/// - acceleration: that of twice the torque limit at the joint's own inertia (links and rotor) where the
///   motion starts;
/// - pressing at the torque limit: 0.25 s. Other patience: SafeStopConfig.
SafeStopConfig default_limits(const Robot& robot, const Scenario& scenario, const JointVector& torque_limit,
                              const JointVector& start);

/// Bandwidth of the disturbance observer, rad/s per joint: the largest up to 40 that leaves a phase margin of
/// 20 degrees (dfdyn::LoopMargin) at 0.6, 1 and 2 times the joint's own inertia where the motion starts, with
/// `delay_ticks` of the bus, half a tick of holding, and half the greatest window of the velocity. Slower
/// motion has longer windows, and less margin.
JointVector default_bandwidth(const Robot& robot, const Scenario& scenario, const JointVector& start,
                              int delay_ticks);

/// The loop that a scenario describes: task, gains and rate of its `controller` (of kind feed_forward),
/// filter of its `derivatives`, torque limit of its `actuators` or else of the robot. The nominal rigid body
/// is `robot` with the scenario's rotors. `learned`: none for nominal feed-forward alone. `delay_ticks`: see
/// LoopConfig. `limits`: replace the defaults. Throws InputError, naming `source` or the model, for what does
/// not fit.
std::unique_ptr<ControlLoop> make_control_loop(const Robot& robot, const Scenario& scenario,
                                               const std::string& source, const LoopModel* learned,
                                               int delay_ticks = 0, const LoopLimits& limits = {});

/// Throws InputError, naming the description's file, unless it has the robot's joints, its joints' rate is
/// that of the loop, its bit rate carries their frames, and the scenario has what its sensor or its drives
/// measure.
void check_bus(const BusDescription& bus, const Robot& robot, const Scenario& scenario);

} // namespace dfdyn::tools
