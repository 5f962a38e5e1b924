// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm_dynamics.hpp"
#include "tools/simulation/lugre_friction.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// What moves the joints.
struct ActuatorModel {
    JointVector rotor_inertia;               ///< kg·m², seen at the joint
    std::vector<LuGreParameters> friction;   ///< per joint
    std::optional<JointVector> torque_limit; ///< N·m, of the actuators; none: unlimited
};

/// An arm with actuators and friction, moved on in fixed steps.
///
/// One step is Strang's splitting: the bristles go half a step at the joints' velocity, then the rigid body a
/// whole one (classical Runge-Kutta of order 4, bristles held), then the bristles another half. Without
/// bristles its order is 4, with them 2. The bristles' own part is exact, so that only the oscillation of a
/// link on its bristles bounds the step: step · sqrt(σ0 / inertia) below 2, and σ1 / inertia · step below 2.
class SimulatedArm {
  public:
    struct State {
        JointVector position;     ///< rad
        JointVector velocity;     ///< rad/s
        JointVector acceleration; ///< rad/s², under the torque of the step that follows
        JointVector friction;     ///< N·m, what opposes the motion
        JointVector torque;       ///< N·m, of the actuators in the step that follows, after their limit
    };

    /// At rest at `position`, bristles relaxed. Throws InputError as ArmDynamics does.
    SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position);

    /// Fixes a body to the last link, in that link's frame; the motion goes on.
    void attach(const InertialParameters& body);

    /// Holds the actuators' torque at `command`, within their limit, and completes the state's acceleration.
    void apply(const JointVector& command);

    /// Goes on by `duration` (s) under that torque.
    void advance(double duration);

    const State& state() const noexcept { return state_; }
    const ArmDynamics& dynamics() const noexcept { return dynamics_; }
    /// Of the position at hand; valid until the next `advance`.
    const ArmDynamics::Configuration& configuration() const noexcept { return configuration_; }

    /// The perfect F/T sensor's reading; the robot must have one.
    Wrench wrench() const { return dynamics_.wrench(configuration_, state_.velocity, state_.acceleration); }

  private:
    JointVector friction_at(const JointVector& velocity) const;
    JointVector acceleration_at(const JointVector& position, const JointVector& velocity);
    void move_bristles(double duration);
    void complete();

    ArmDynamics dynamics_;
    ActuatorModel actuators_;
    std::vector<LuGreFriction> friction_;
    State state_;
    ArmDynamics::Configuration configuration_, stage_;
};

} // namespace dfdyn::tools
