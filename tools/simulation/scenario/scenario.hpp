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

/// Sampling times and columns of the recording.
struct RecordingModel {
    double rate_hz = 100;
    double first_at_s = 0; ///< in simulated time
    std::size_t samples = 1000;
    /// standard deviation of the sampling time; the stamp includes the deviation
    double instant_jitter_s = 0;
    double stamp_jitter_s = 0;        ///< standard deviation of the stamp's error
    std::vector<std::string> columns; ///< some of q, qd, qdd, tau, i, wrench
};

/// All inputs of a simulation except the robot. File format: docs/reference/scenario.md.
struct Scenario {
    std::uint64_t seed = 1;
    double integration_rate_hz = 8000; ///< a multiple of every sensor's and the controller's rate
    RecordingModel recording;
    TaskModel task;
    ControllerModel controller;
    RobotErrors robot_errors; ///< unknown to the controller
    JointLoads loads;         ///< unknown to the controller
    JointVector start_offset; ///< rad: where the arm starts, minus the first reference; empty: 0
    ActuatorModel actuators;
    std::vector<Payload> payloads; ///< in chronological order
    std::vector<Fault> faults;     ///< each with its own start time
    TorqueSensorModel torque_sensor;
    std::optional<OutputNoiseModel> output_noise;
    EncoderModel encoders;
    DerivativeModel derivatives;
    std::optional<WrenchSensorModel> force_torque;
};

/// Returns where the arm of `scenario` starts, rad. `first`: the task's first reference.
JointVector start_position(const Scenario& scenario, const JointVector& first);

/// The part of the robot's URDF that a scenario uses.
struct ScenarioChain {
    std::string tip; ///< link
    /// m, in that link's frame: the point that tasks move
    Eigen::Vector3d tip_point = Eigen::Vector3d::Zero();
    std::string base;             ///< link; empty: the root
    std::string ft_joint;         ///< empty: determined automatically
    std::string wrench_direction; ///< child_to_parent, parent_to_child; empty: from the robot's file
    std::vector<double> gravity;  ///< m/s², in the frame of the robot's root; empty: 9.81 along -z
};

/// Reads the chain only, because the robot is needed to read the rest.
ScenarioChain read_scenario_chain(const std::filesystem::path& path);

/// Reads a scenario for `robot`. Throws InputError with the file and the path of the field for a field that
/// is unknown, missing, out of range, of the wrong type or length, or inconsistent with another; and for a
/// robot without joints or with more than `largest_simulated_chain`, each soft one counted twice.
Scenario read_scenario(const std::filesystem::path& path, const Robot& robot);

} // namespace dfdyn::tools
