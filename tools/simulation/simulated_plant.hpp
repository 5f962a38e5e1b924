// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/scenario/scenario.hpp"

#include <optional>

namespace dfdyn::tools {

/// The arm of a scenario without its controller: its input is the torque, its outputs are the sensors'
/// readings.
class SimulatedPlant {
  public:
    /// Starts at rest. `first`: the task's first reference, see start_position. Throws InputError as
    /// SimulatedArm does.
    SimulatedPlant(const Robot& robot, const Scenario& scenario, const JointVector& first);

    /// Sets the torque, subject to the actuators' limit.
    void apply(const JointVector& torque) { arm_.apply(torque); }

    /// Advances to `time_s`, in steps of the scenario's integration. Throws InputError with the time if the
    /// simulation diverges.
    void advance_to(double time_s);

    double time_s() const noexcept { return static_cast<double>(step_) * period_s_; }
    /// reading of the encoders
    const JointVector& position() const noexcept { return encoders_.reading(); }
    /// Reading of the torque sensors. Each call draws new noise.
    JointVector torque() { return torque_sensor_.read(arm_.state().torque); }
    /// Reading of the F/T sensor; the scenario must have one.
    const Wrench& wrench() const { return wrench_sensor_->reading(); }
    const SimulatedArm::State& truth() const noexcept { return arm_.state(); }
    /// Active faults of the connection.
    const LinkFaults& link_faults() const noexcept { return faults_.now().link; }

  private:
    void observe();

    double period_s_;
    std::int64_t encoder_steps_;
    SimulatedArm arm_;
    PayloadSchedule payloads_;
    FaultSchedule faults_;
    Encoders encoders_;
    std::optional<WrenchSensor> wrench_sensor_;
    TorqueSensor torque_sensor_;
    std::int64_t step_ = 0;
};

} // namespace dfdyn::tools
