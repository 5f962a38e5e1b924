// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/scenario/scenario.hpp"

#include <memory>

namespace dfdyn::tools {

/// What is so when a sample is taken, whatever the sensors show.
struct SimulatedTruth {
    double time_s = 0;
    JointVector position, velocity, acceleration;
    JointVector torque;   ///< of the actuators at the joint: inverse dynamics + rotor + friction
    JointVector friction; ///< what opposes the motion
    Wrench wrench = Wrench::Zero();
    /// Of the motors, where the encoders sit: the joints' but where a joint is soft.
    JointVector motor_position, motor_velocity, motor_acceleration;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero(); ///< m, in the base's frame
};

/// One row of the recording.
struct SimulatedSample {
    double time_s = 0;                            ///< as its stamp says
    JointVector position, velocity, acceleration; ///< encoders, and the robot's own estimates
    JointVector torque;
    Wrench wrench = Wrench::Zero();
    SimulatedTruth truth;
};

/// An arm, its task, controller, actuators and sensors, from rest at the task's first point. Everything is
/// determined by robot and scenario, its seed included.
class Simulation {
  public:
    /// Throws InputError when the task cannot be done: see make_task.
    Simulation(const Robot& robot, const Scenario& scenario);

    /// The next row. Throws InputError, with the time, when the reference leaves the joints' limits or the
    /// simulation is no longer finite.
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
    DerivativeEstimator control_derivatives_; ///< the controller's own, at the encoders' rate
    DerivativeEstimator derivatives_;         ///< recorded
    std::optional<WrenchSensor> wrench_sensor_;
    TorqueSensor torque_sensor_;
    std::optional<OutputNoise> output_noise_;
    NormalSource jitter_;
    std::int64_t step_ = 0; ///< of the state at hand
    std::size_t taken_ = 0;
};

} // namespace dfdyn::tools
