// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/scenario/scenario.hpp"

namespace dfdyn::tests {

/// A pendulum: one joint about a horizontal axis with all mass at distance `length`. It hangs along -z at 0
/// rad.
inline tools::Robot pendulum(double mass, double length) {
    tools::RobotJoint joint;
    joint.name = "swing";
    joint.link = "rod";
    joint.axis = Eigen::Vector3d::UnitX();
    const double moment = -mass * length;
    const double inertia = mass * length * length;
    joint.inertia << mass, 0, 0, moment, inertia, 0, 0, inertia, 0, 0;
    tools::Robot robot;
    robot.name = "pendulum";
    robot.base = "base";
    robot.tip = "rod";
    robot.joints = {joint};
    robot.tip_placement.translation() = Eigen::Vector3d(0, 0, -length);
    return robot;
}

/// Actuators without friction, rotors or limits.
inline tools::ActuatorModel free_actuators(int joints) {
    tools::ActuatorModel model;
    model.rotor_inertia = tools::JointVector::Zero(joints);
    model.friction.resize(static_cast<std::size_t>(joints));
    return model;
}

/// A scenario in which a good controller keeps all joints near `centre`; its sensors are perfect.
inline tools::Scenario quiet_scenario(int joints) {
    tools::Scenario scenario;
    tools::MultisineTask task;
    task.centre = tools::JointVector::Constant(joints, 0.3);
    task.amplitude = tools::JointVector::Constant(joints, 0.4);
    scenario.task = task;
    scenario.controller.position_gain = tools::JointVector::Constant(joints, 900);
    scenario.controller.velocity_gain = tools::JointVector::Constant(joints, 60);
    scenario.actuators = free_actuators(joints);
    scenario.torque_sensor.noise = tools::JointVector::Zero(joints);
    scenario.encoders.eccentricity = tools::JointVector::Zero(joints);
    scenario.encoders.eccentricity_phase = tools::JointVector::Zero(joints);
    scenario.derivatives.noise_bound = 1e-6;
    return scenario;
}

} // namespace dfdyn::tests
