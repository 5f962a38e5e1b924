// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/arm_dynamics.hpp"
#include "tools/simulation/task/task.hpp"

#include <cstdint>

namespace dfdyn::tools {

enum class ControllerKind {
    computed_torque,      ///< M(q)·(q̈ref + velocity_gain·ė + position_gain·e) + bias(q, q̇)
    gravity_compensation, ///< velocity_gain·ė + position_gain·e + gravity(q)
    feed_forward, ///< velocity_gain·ė + position_gain·e + inverse dynamics of the reference's motion
};

struct ControllerModel {
    ControllerKind kind = ControllerKind::computed_torque;
    double rate_hz = 1000;
    JointVector position_gain; ///< computed torque: 1/s²; else N·m/rad
    JointVector velocity_gain; ///< computed torque: 1/s; else N·m·s/rad
    /// standard deviation of each link's relative mass error in the controller's model of the arm; first
    /// moment and inertia change in proportion
    double mass_error = 0;
};

/// Computes torques that make the arm follow a reference. Its model contains neither friction nor the true
/// masses.
class Controller {
  public:
    Controller(const Robot& robot, const JointVector& rotor_inertia, const ControllerModel& model,
               std::uint64_t seed);

    /// Returns the torque from the measured state.
    JointVector torque(const Reference& reference, const JointVector& position, const JointVector& velocity);

  private:
    ControllerModel model_;
    ArmDynamics dynamics_;
    ArmDynamics::Configuration configuration_;
};

} // namespace dfdyn::tools
