// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm/simulated_arm.hpp"
#include "tools/simulation/faults/fault_schedule.hpp"
#include "tools/simulation/scenario/payload_schedule.hpp"
#include "tools/simulation/scenario/robot_errors.hpp"
#include "tools/simulation/sensors/derivative_estimator.hpp"
#include "tools/simulation/sensors/encoders.hpp"
#include "tools/simulation/sensors/output_noise.hpp"
#include "tools/simulation/sensors/torque_sensor.hpp"
#include "tools/simulation/sensors/wrench_sensor.hpp"
#include "tools/simulation/task/controller.hpp"
#include "tools/simulation/task/task.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// When samples are taken, and what is written.
struct RecordingModel {
    double rate_hz = 100;
    double first_at_s = 0; ///< of the simulation's time
    std::size_t samples = 1000;
    double instant_jitter_s = 0;      ///< standard deviation of when a sample is taken; its stamp tells
    double stamp_jitter_s = 0;        ///< standard deviation of the stamp's error
    std::vector<std::string> columns; ///< of q, qd, qdd, tau, i, wrench
};

/// All that a simulation needs beside the robot. Its file: docs/reference/scenario.md.
struct Scenario {
    std::uint64_t seed = 1;
    double integration_rate_hz = 8000; ///< a multiple of every sensor's and the controller's rate
    RecordingModel recording;
    TaskModel task;
    ControllerModel controller;
    RobotErrors robot_errors; ///< which no controller knows
    JointLoads loads;         ///< likewise
    ActuatorModel actuators;
    std::vector<Payload> payloads; ///< in order of time
    std::vector<Fault> faults;     ///< that begin when their time comes
    TorqueSensorModel torque_sensor;
    std::optional<OutputNoiseModel> output_noise;
    EncoderModel encoders;
    DerivativeModel derivatives;
    std::optional<WrenchSensorModel> force_torque;
};

/// Which part of the robot's URDF a scenario is about.
struct ScenarioChain {
    std::string tip;                                     ///< link
    Eigen::Vector3d tip_point = Eigen::Vector3d::Zero(); ///< m, in that link's frame: what tasks move
    std::string base;                                    ///< link; empty: the root
    std::string ft_joint;                                ///< empty: found by itself
    std::string wrench_direction; ///< child_to_parent, parent_to_child; empty: the robot's own
    std::vector<double> gravity;  ///< m/s², in the frame of the robot's root; empty: 9.81 along -z
};

/// Reads the chain only: the robot must be known before the rest can be.
ScenarioChain read_scenario_chain(const std::filesystem::path& path);

/// Reads a scenario for `robot`. Throws InputError with file and path of the field: unknown, missing, of
/// another type, out of range, not one number per joint, or in contradiction to another.
Scenario read_scenario(const std::filesystem::path& path, const Robot& robot);

} // namespace dfdyn::tools
