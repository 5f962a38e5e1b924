// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/arm_dynamics.hpp"
#include "tools/simulation/gear.hpp"
#include "tools/simulation/joint_loads.hpp"
#include "tools/simulation/lugre_friction.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// What moves the joints.
struct ActuatorModel {
    JointVector rotor_inertia;               ///< kg·m², seen at the joint
    std::vector<LuGreParameters> friction;   ///< per joint, on the motor's side of its gear
    std::optional<JointVector> torque_limit; ///< N·m, of the actuators; none: unlimited
    double bandwidth_hz = 0;                 ///< of the torque behind its command (first order); 0: at once
    GearModel gear;                          ///< soft joints need a rotor
};

/// An arm with actuators and friction, moved on in fixed steps.
///
/// One step is Strang's splitting: the bristles go half a step at the joints' velocity, then the rigid body a
/// whole one (classical Runge-Kutta of order 4, bristles held), then the bristles another half. Without
/// bristles its order is 4, with them 2. The bristles' own part is exact, so that only the oscillation of a
/// link on its bristles bounds the step: step · sqrt(σ0 / inertia) below 2, and σ1 / inertia · step below 2.
/// A soft joint has its motor's position as a further coordinate; its stiffness and the smaller of its two
/// inertias bound the step in the same way.
class SimulatedArm {
  public:
    struct State {
        JointVector position;     ///< rad
        JointVector velocity;     ///< rad/s
        JointVector acceleration; ///< rad/s², under the torque of the step that follows
        JointVector friction;     ///< N·m, what opposes the motion
        JointVector torque;       ///< N·m, of the actuators in the step that follows, after their limit
        /// Of the motors, seen at the joint: those of the joints but where a joint is soft.
        JointVector motor_position, motor_velocity, motor_acceleration;
    };

    /// At rest at `position`, bristles and gears relaxed. Throws InputError as ArmDynamics does, when a soft
    /// joint has no rotor, and when joints and motors of soft ones are more than the simulation holds.
    SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position,
                 const JointLoads& loads = {});

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
    Wrench wrench() const;

  private:
    /// What changes within a step beside position and velocity.
    struct Instant {
        double time_s;
        JointVector torque; ///< of the actuators
    };

    Eigen::Index joint_count() const noexcept { return dynamics_.joint_count(); }
    void add_motors();
    Instant instant(double later_s) const;
    JointVector friction_at(const JointVector& velocity) const;
    JointVector acceleration_at(const ArmDynamics::Configuration& configuration, const JointVector& position,
                                const JointVector& velocity, const Instant& instant) const;
    JointVector acceleration_at(const JointVector& position, const JointVector& velocity,
                                const Instant& instant);
    void move_bristles(double duration);
    void complete();
    void accelerate();

    ArmDynamics dynamics_;
    ActuatorModel actuators_;
    JointLoads loads_;
    std::vector<LuGreFriction> friction_;
    std::vector<Eigen::Index> motor_; ///< per joint: which coordinate is its motor's
    JointVector position_, velocity_; ///< coordinates: joints, then motors of soft ones
    JointVector command_;
    bool commanded_ = false; ///< the first command is there before the brakes let go
    JointVector load_;       ///< N·m, what the gears pass on; friction sees it a step later
    double time_s_ = 0;
    State state_;
    ArmDynamics::Configuration configuration_, stage_;
};

} // namespace dfdyn::tools
