// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"
#include "tools/control/loop/control_loop.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A learned model for the loop.
struct LoopModel {
    TrainedModel model;
    std::string source;               ///< for messages
    bool from_prior = false;          ///< start without the initial weights from training
    std::vector<std::byte> learned{}; ///< initial state, a LearnedFeedForward::snapshot; empty: none
    std::string learned_source{};     ///< for messages
};

/// Limits set by the user; empty or none: the defaults of `default_limits`. A single value applies to all
/// joints.
struct LoopLimits {
    std::vector<double> following_error; ///< rad, m
    std::vector<double> speed;           ///< rad/s, m/s
    StopMode mode = StopMode::hold;
    std::vector<double> observer_bandwidth{}; ///< rad/s; 0: no observer
    std::vector<double> learned_limit{};      ///< limit of the learned torque, as shares of the torque limit
    FindingActions actions{};
    FindingAction on_contact = FindingAction::report;
    std::optional<double> contact_rate_per_hour{}; ///< of false contacts; none: the model's
    double contact_calibration_s = 0;              ///< see ContactSetup
};

/// Returns the default limits of a loop with these gains and torque limits:
/// - following error: 0.8 of the torque limit divided by the position gain; at most 0.5 rad or 0.1 m;
/// - motion of the reference while a joint sticks: a quarter of the torque limit divided by the position
///   gain, for friction of up to an eighth of the limit in both directions;
/// - speed: the robot's limit; none if the robot has none, or one above 100 rad/s or m/s;
/// - acceleration: twice the torque limit divided by the joint's own inertia (links and rotor) at the start
///   of the motion;
/// - time at the torque limit: 0.25 s. Other values: SafeStopConfig.
SafeStopConfig default_limits(const Robot& robot, const Scenario& scenario, const JointVector& torque_limit,
                              const JointVector& start);

/// Returns the loop that a scenario describes: its task, gains and rate of its `controller` (of kind
/// feed_forward), and filter of its `derivatives`. The torque limit is its `actuators`' or the
/// robot's. The nominal rigid body is `robot` with the scenario's rotors. `learned`: null for nominal
/// feed-forward only. `delay_ticks`: see LoopConfig. `limits`: replace the defaults. Throws InputError,
/// naming `source` or the model, for inconsistent inputs.
std::unique_ptr<ControlLoop> make_control_loop(const Robot& robot, const Scenario& scenario,
                                               const std::string& source, const LoopModel* learned,
                                               int delay_ticks = 0, const LoopLimits& limits = {});

/// Throws InputError, naming the description's file, unless a bus description has the robot's joints, the
/// loop's rate and a sufficient bit rate. The scenario must have the quantities that the bus' sensor or
/// drives measure.
void check_bus(const BusDescription& bus, const Robot& robot, const Scenario& scenario);

} // namespace dfdyn::tools
