// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/scenario/scenario.hpp"

#include <memory>

namespace dfdyn::tools {

/// True quantities at a sample, independent of the sensors.
struct SimulatedTruth {
    double time_s = 0;
    JointVector position, velocity, acceleration;
    JointVector torque;   ///< of the actuators at the joint: inverse dynamics + rotor + friction
    JointVector friction; ///< opposes the motion
    Wrench wrench = Wrench::Zero();
    /// Motion of the motors, where the encoders are. It equals the joints' motion except at soft joints.
    JointVector motor_position, motor_velocity, motor_acceleration;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero(); ///< m, in the base's frame
};

/// One row of the recording.
struct SimulatedSample {
    double time_s = 0;                            ///< the sample's stamp
    JointVector position, velocity, acceleration; ///< from the encoders, and the robot's own estimates
    JointVector torque;
    Wrench wrench = Wrench::Zero();
    SimulatedTruth truth;
};

/// An arm with its task, controller, actuators and sensors, starting at rest at the task's first point. Robot
/// and scenario, including its seed, determine the result completely.
class Simulation {
  public:
    /// Throws InputError if the task is impossible: see make_task.
    Simulation(const Robot& robot, const Scenario& scenario);

    /// Returns the next row, at least one step of the integration after the previous one. Throws InputError
    /// with the time if the reference exceeds the joints' limits or the simulation diverges.
    SimulatedSample next();

  private:
    void observe();
    void control();
    double jitter(double deviation_s);
    SimulatedSample take();

    Robot robot_;
    Scenario scenario_;
    double period_s_;
    std::int64_t encoder_steps_, derivative_steps_, control_steps_;
    std::unique_ptr<Task> task_;
    Reference reference_;
    SimulatedArm arm_;
    PayloadSchedule payloads_;
    FaultSchedule faults_;
    Controller controller_;
    Encoders encoders_;
    DerivativeEstimator control_derivatives_; ///< used by the controller, at the encoders' rate
    DerivativeEstimator derivatives_;         ///< recorded
    std::optional<WrenchSensor> wrench_sensor_;
    TorqueSensor torque_sensor_;
    std::optional<OutputNoise> output_noise_;
    NormalSource jitter_;
    std::int64_t step_ = 0; ///< of the current state
    std::size_t taken_ = 0;
};

} // namespace dfdyn::tools
