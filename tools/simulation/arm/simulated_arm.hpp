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

/// Actuators, friction and gears of the joints.
struct ActuatorModel {
    JointVector rotor_inertia;               ///< kg·m², at the joint's side of the gear
    std::vector<LuGreParameters> friction;   ///< per joint, at the motor's side of its gear
    std::optional<JointVector> torque_limit; ///< N·m, of the actuators; empty: unlimited
    /// bandwidth of the torque's response to its command (first order); 0: unlimited
    double bandwidth_hz = 0;
    GearModel gear; ///< soft joints need a rotor
};

/// An arm with actuators and friction, integrated in fixed steps.
///
/// One step is a Strang splitting: half a step of the bristles, a whole step of the rigid body, and another
/// half step of the bristles. The bristles move at constant joint velocity; the rigid body uses classical
/// fourth-order Runge-Kutta with held bristles. The order is 4 without bristles and 2 with them. The
/// bristles' part is exact, so only the oscillation of a link on its bristles limits the step: step · sqrt(σ0
/// / inertia) and σ1 / inertia · step must be below 2.
///
/// A soft joint is represented by two joints about one axis: the rotor turns relative to the previous link,
/// and the link turns relative to the rotor, driven by the gear. The rotor is a separate body that the
/// previous links carry. The gear's stiffness and the smaller of the two inertias limit the step in the same
/// way.
class SimulatedArm {
  public:
    struct State {
        JointVector position;     ///< rad
        JointVector velocity;     ///< rad/s
        JointVector acceleration; ///< rad/s², under the torque of the next step
        JointVector friction;     ///< N·m, opposes the motion
        JointVector torque;       ///< N·m, of the actuators in the next step, after their limit
        /// Motion of the motors, at the joint's side of the gear. It equals the joints' motion except at soft
        /// joints.
        JointVector motor_position, motor_velocity, motor_acceleration;
    };

    /// Starts at rest at `position`, with relaxed bristles and gears deflected by the weight. Throws
    /// InputError as ArmDynamics does, if a soft joint has no rotor or is prismatic, and for more than
    /// `largest_simulated_chain` joints, each soft one counted twice.
    SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position,
                 JointLoads loads = {});

    /// Fixes a body to the last link, given in that link's frame. The motion continues.
    void attach(const InertialParameters& body);
    /// Removes all attached bodies.
    void release();

    /// Replaces the active faults.
    void set_faults(const ArmFaults& faults);

    /// Sets the actuators' torque to `command`, subject to their limit and faults, and computes the state's
    /// acceleration.
    void apply(const JointVector& command);

    /// Advances the simulation by `duration` (s) with this torque.
    void advance(double duration);

    const State& state() const noexcept { return state_; }
    /// Dynamics with two joints for each soft joint.
    const ArmDynamics& dynamics() const noexcept { return dynamics_; }
    /// Configuration at the current position; valid until the next `advance`.
    const ArmDynamics::Configuration& configuration() const noexcept { return configuration_; }

    /// Reading of an ideal F/T sensor; the robot must have one.
    Wrench wrench() const;

  private:
    /// Inputs of a step in addition to position and velocity.
    struct Instant {
        double time_s;
        JointVector torque; ///< of the actuators
    };

    Eigen::Index joint_count() const noexcept { return static_cast<Eigen::Index>(motor_.size()); }
    bool soft(Eigen::Index joint) const { return actuators_.gear.soft(joint); }
    void rest_on_gears();
    /// Index of the coordinate of a joint's motor. For a soft joint, the next coordinate is the position of
    /// the link relative to its rotor.
    Eigen::Index motor(Eigen::Index joint) const { return motor_[static_cast<std::size_t>(joint)]; }
    /// Converts one value per coordinate to one value per link.
    JointVector of_joints(const JointVector& coordinates) const;
    JointVector of_motors(const JointVector& coordinates) const;
    double gear_torque(Eigen::Index joint, const JointVector& position, const JointVector& velocity) const;
    JointVector forces(const ArmDynamics::Configuration& configuration, const JointVector& position,
                       const JointVector& velocity, const Instant& instant) const;
    void add_loads(const ArmDynamics::Configuration& configuration, const JointVector& position,
                   const JointVector& velocity, double time_s, JointVector& force) const;
    void add_faults(const ArmDynamics::Configuration& configuration, JointVector& force) const;
    /// The coordinate that moves a push's point, and this point in the base's frame.
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
    /// of the last link, and beyond the sensor; both without payloads
    InertialParameters bare_, bare_beyond_;
    JointVector asked_, command_; ///< torque commands before and after limit and faults
    bool commanded_ = false;      ///< the brakes release with the first command
    JointVector load_;            ///< N·m, transmitted by the gears; the friction uses it one step later
    double time_s_ = 0;
    State state_;
    ArmDynamics::Configuration configuration_, stage_;
};

} // namespace dfdyn::tools
