// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/arm_dynamics.hpp"
#include "tools/simulation/arm/gear.hpp"
#include "tools/simulation/arm/joint_loads.hpp"
#include "tools/simulation/arm/lugre_friction.hpp"
#include "tools/simulation/faults/fault.hpp"

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
///
/// A soft joint is two joints about one axis: the rotor turns against the link before, the link against the
/// rotor, pushed by the gear. The rotor is a body of its own there, that is carried along by the links before
/// it. A gear's stiffness and the smaller of its two inertias bound the step as bristles do.
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

    /// At rest at `position`, bristles relaxed, gears under the weight. Throws InputError as ArmDynamics
    /// does, and when a soft joint has no rotor or is prismatic.
    SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position,
                 JointLoads loads = {});

    /// Fixes a body to the last link, in that link's frame; the motion goes on.
    void attach(const InertialParameters& body);
    /// Takes off all that was attached.
    void release();

    /// These faults act from now on, and no others.
    void set_faults(const ArmFaults& faults);

    /// Holds the actuators' torque at `command`, within their limit and with their faults, and completes the
    /// state's acceleration.
    void apply(const JointVector& command);

    /// Goes on by `duration` (s) under that torque.
    void advance(double duration);

    const State& state() const noexcept { return state_; }
    /// Of the joints, soft ones counted twice.
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

    Eigen::Index joint_count() const noexcept { return static_cast<Eigen::Index>(motor_.size()); }
    bool soft(Eigen::Index joint) const { return actuators_.gear.soft(joint); }
    void rest_on_gears();
    /// The coordinate of a joint's motor; that of a soft joint's link against its rotor is the next.
    Eigen::Index motor(Eigen::Index joint) const { return motor_[static_cast<std::size_t>(joint)]; }
    /// Of the links, from one value per coordinate.
    JointVector of_joints(const JointVector& coordinates) const;
    JointVector of_motors(const JointVector& coordinates) const;
    double gear_torque(Eigen::Index joint, const JointVector& position, const JointVector& velocity) const;
    JointVector forces(const ArmDynamics::Configuration& configuration, const JointVector& position,
                       const JointVector& velocity, const Instant& instant) const;
    void add_loads(const ArmDynamics::Configuration& configuration, const JointVector& position,
                   const JointVector& velocity, double time_s, JointVector& force) const;
    void add_faults(const ArmDynamics::Configuration& configuration, JointVector& force) const;
    /// The coordinate that moves a push's point, and that point in the base's frame.
    Eigen::Index pushed_link(const Push& push) const;
    Eigen::Vector3d pushed_point(const Push& push, const ArmDynamics::Configuration& configuration) const;
    Instant instant(double later_s) const;
    JointVector friction_at(const JointVector& velocity) const;
    JointVector acceleration_at(const JointVector& position, const JointVector& velocity,
                                const Instant& instant);
    void move_bristles(double duration);
    void complete();
    void accelerate();

    ArmDynamics dynamics_;
    ActuatorModel actuators_;
    JointLoads loads_;
    std::vector<LuGreFriction> friction_;
    std::vector<Eigen::Index> motor_;
    JointVector position_, velocity_, acceleration_; ///< coordinates
    std::optional<ArmFaults> faults_;
    InertialParameters bare_, bare_beyond_; ///< of the last link, and beyond the sensor, without payloads
    JointVector asked_, command_;           ///< before and after limit and faults
    bool commanded_ = false;                ///< the first command is there before the brakes let go
    JointVector load_;                      ///< N·m, what the gears pass on; friction sees it a step later
    double time_s_ = 0;
    State state_;
    ArmDynamics::Configuration configuration_, stage_;
};

} // namespace dfdyn::tools
