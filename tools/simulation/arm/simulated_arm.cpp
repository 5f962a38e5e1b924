// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/arm/simulated_arm.hpp"

#include "tools/base/text/error.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Returns a body without mass, with inertia about the joint's axis only.
InertialParameters rotor_body(const Eigen::Vector3d& axis, double inertia) {
    return body_parameters(0, Eigen::Vector3d::Zero(), inertia * axis * axis.transpose());
}

void check_soft(const RobotJoint& joint, double rotor_inertia) {
    if (joint.prismatic || !(rotor_inertia > 0)) {
        throw InputError("joint " + joint.name +
                         ": expected a soft joint to turn and to have a rotor, found " +
                         (joint.prismatic ? "a prismatic one" : "none"));
    }
}

/// Replaces each soft joint by two joints: the rotor, and the link relative to the rotor.
Robot split(const Robot& robot, const ActuatorModel& actuators) {
    Robot result = robot;
    result.joints.clear();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        if (actuators.gear.soft(k)) {
            RobotJoint rotor = robot.joints[i];
            check_soft(rotor, actuators.rotor_inertia[k]);
            rotor.inertia = rotor_body(rotor.axis, actuators.rotor_inertia[k]);
            result.joints.push_back(rotor);
        }
        result.joints.push_back(robot.joints[i]);
        if (actuators.gear.soft(k)) {
            result.joints.back().placement.setIdentity();
        }
        if (robot.sensor && robot.sensor->link == i + 1) {
            result.sensor->link = result.joints.size();
        }
    }
    return result;
}

/// Returns the inertias, one per coordinate, of rotors that have inertia about their joint only. Other rotors
/// are bodies. Throws InputError for more coordinates than a JointVector holds.
JointVector rotors(const ActuatorModel& actuators) {
    const Eigen::Index joints = actuators.rotor_inertia.size();
    const Eigen::Index coordinates = actuators.gear.coordinate_count(joints);
    if (coordinates > largest_simulated_chain) {
        throw InputError("actuators: expected at most " + std::to_string(largest_simulated_chain) +
                         " joints, each soft one counted twice, found " + std::to_string(coordinates));
    }
    JointVector result = JointVector::Zero(coordinates);
    for (Eigen::Index i = 0, coordinate = 0; i < joints; ++i) {
        if (actuators.gear.soft(i)) {
            coordinate += 2;
        } else {
            result[coordinate++] = actuators.rotor_inertia[i];
        }
    }
    return result;
}

} // namespace

SimulatedArm::SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position,
                           JointLoads loads)
    : dynamics_(split(robot, actuators), rotors(actuators)), actuators_(actuators), loads_(std::move(loads)) {
    for (const LuGreParameters& parameters : actuators.friction) {
        friction_.emplace_back(parameters);
    }
    position_ = velocity_ = JointVector::Zero(dynamics_.joint_count());
    for (Eigen::Index i = 0, coordinate = 0; i < position.size(); ++i) {
        position_[coordinate] = position[i];
        motor_.push_back(coordinate);
        coordinate += soft(i) ? 2 : 1;
    }
    bare_ = dynamics_.robot().joints.back().inertia;
    bare_beyond_ = robot.sensor ? robot.sensor->inertia_beyond : InertialParameters::Zero();
    rest_on_gears();
    state_.torque = asked_ = command_ = load_ = JointVector::Zero(position.size());
    complete();
}

/// Deflects the gears by the weight of the links at this position.
void SimulatedArm::rest_on_gears() {
    dynamics_.configure(position_, configuration_);
    const JointVector at_rest = JointVector::Zero(position_.size());
    const JointVector weight = dynamics_.inverse(configuration_, at_rest, at_rest);
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        if (soft(i)) {
            const Eigen::Index link = motor(i) + 1;
            const double play =
                weight[link] == 0 ? 0 : std::copysign(actuators_.gear.gap[i] / 2, weight[link]);
            position_[link] = -weight[link] / actuators_.gear.stiffness[i] - play;
        }
    }
}

void SimulatedArm::attach(const InertialParameters& body) {
    Robot robot = dynamics_.robot();
    robot.joints.back().inertia += body;
    if (robot.sensor && robot.sensor->link == robot.joints.size()) {
        robot.sensor->inertia_beyond += body;
    }
    dynamics_ = ArmDynamics(std::move(robot), rotors(actuators_));
    complete();
}

void SimulatedArm::release() {
    Robot robot = dynamics_.robot();
    robot.joints.back().inertia = bare_;
    if (robot.sensor) {
        robot.sensor->inertia_beyond = bare_beyond_;
    }
    dynamics_ = ArmDynamics(std::move(robot), rotors(actuators_));
    complete();
}

void SimulatedArm::set_faults(const ArmFaults& faults) {
    faults_ = faults;
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        friction_[static_cast<std::size_t>(i)].set_factor(faults.friction_factor[i]);
    }
    if (commanded_) {
        apply(JointVector(asked_));
    }
    state_.friction = friction_at(velocity_);
    accelerate();
}

void SimulatedArm::apply(const JointVector& command) {
    asked_ = command_ = command;
    if (actuators_.torque_limit) {
        command_ = command.cwiseMin(*actuators_.torque_limit).cwiseMax(-*actuators_.torque_limit);
    }
    if (faults_) {
        command_ = faults_->actuator_gain.cwiseProduct(command_)
                       .cwiseMin(faults_->actuator_limit)
                       .cwiseMax(-faults_->actuator_limit);
    }
    if (actuators_.bandwidth_hz > 0 && commanded_) {
        return; // the torque is computed later
    }
    commanded_ = true;
    state_.torque = command_;
    accelerate();
}

SimulatedArm::Instant SimulatedArm::instant(double later_s) const {
    if (!(actuators_.bandwidth_hz > 0)) {
        return {time_s_ + later_s, state_.torque};
    }
    const double left = std::exp(-2 * std::numbers::pi * actuators_.bandwidth_hz * later_s);
    return {time_s_ + later_s, command_ + left * (state_.torque - command_)};
}

JointVector SimulatedArm::of_motors(const JointVector& coordinates) const {
    JointVector result(joint_count());
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        result[i] = coordinates[motor(i)];
    }
    return result;
}

JointVector SimulatedArm::of_joints(const JointVector& coordinates) const {
    JointVector result = of_motors(coordinates);
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        if (soft(i)) {
            result[i] += coordinates[motor(i) + 1];
        }
    }
    return result;
}

JointVector SimulatedArm::friction_at(const JointVector& velocity) const {
    JointVector result(joint_count());
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        result[i] = friction_[static_cast<std::size_t>(i)].torque(velocity[motor(i)]);
    }
    return result;
}

double SimulatedArm::gear_torque(Eigen::Index joint, const JointVector& position,
                                 const JointVector& velocity) const {
    const Eigen::Index link = motor(joint) + 1;
    return actuators_.gear.torque(joint, -position[link], -velocity[link]);
}

void SimulatedArm::add_loads(const ArmDynamics::Configuration& configuration, const JointVector& position,
                             const JointVector& velocity, double time_s, JointVector& force) const {
    const JointVector load = loads_.torque(of_joints(position), of_joints(velocity), time_s);
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        force[motor(i)] += load[i];
        if (soft(i)) {
            force[motor(i) + 1] += load[i];
        }
    }
    const Eigen::Vector3d push = loads_.tip_force(time_s);
    if (!push.isZero(0)) {
        force += dynamics_.tip_jacobian(configuration).transpose() * push;
    }
}

Eigen::Index SimulatedArm::pushed_link(const Push& push) const {
    if (!push.link) {
        return dynamics_.joint_count() - 1;
    }
    return motor(*push.link) + (soft(*push.link) ? 1 : 0);
}

Eigen::Vector3d SimulatedArm::pushed_point(const Push& push,
                                           const ArmDynamics::Configuration& configuration) const {
    return push.link ? configuration.place[static_cast<std::size_t>(pushed_link(push))] * push.point
                     : dynamics_.tip(configuration);
}

void SimulatedArm::add_faults(const ArmDynamics::Configuration& configuration, JointVector& force) const {
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        force[motor(i)] += faults_->load[i];
        if (soft(i)) {
            force[motor(i) + 1] += faults_->load[i];
        }
    }
    for (const Push& push : faults_->pushes) {
        const Eigen::Vector3d point = pushed_point(push, configuration);
        force += dynamics_.point_jacobian(configuration, pushed_link(push), point).transpose() * push.force;
    }
}

/// Returns the generalized forces, one per coordinate.
JointVector SimulatedArm::forces(const ArmDynamics::Configuration& configuration, const JointVector& position,
                                 const JointVector& velocity, const Instant& instant) const {
    const JointVector drive = instant.torque - friction_at(velocity);
    JointVector force(position.size());
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        force[motor(i)] = drive[i];
        if (soft(i)) {
            force[motor(i) + 1] = gear_torque(i, position, velocity);
        }
    }
    if (!loads_.none()) {
        add_loads(configuration, position, velocity, instant.time_s, force);
    }
    if (faults_) {
        add_faults(configuration, force);
    }
    return force;
}

JointVector SimulatedArm::acceleration_at(const JointVector& position, const JointVector& velocity,
                                          const Instant& instant) {
    dynamics_.configure(position, stage_);
    return dynamics_.forward(stage_, velocity, forces(stage_, position, velocity, instant));
}

void SimulatedArm::move_bristles(double duration) {
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        friction_[static_cast<std::size_t>(i)].advance(velocity_[motor(i)], duration);
    }
}

void SimulatedArm::accelerate() {
    acceleration_ = dynamics_.forward(configuration_, velocity_,
                                      forces(configuration_, position_, velocity_, instant(0)));
    state_.acceleration = of_joints(acceleration_);
    state_.motor_acceleration = of_motors(acceleration_);
}

void SimulatedArm::complete() {
    dynamics_.configure(position_, configuration_);
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        friction_[static_cast<std::size_t>(i)].set_conditions(time_s_, load_[i]);
    }
    state_.position = of_joints(position_);
    state_.velocity = of_joints(velocity_);
    state_.motor_position = of_motors(position_);
    state_.motor_velocity = of_motors(velocity_);
    state_.friction = friction_at(velocity_);
    accelerate();
    load_ = state_.torque - state_.friction - actuators_.rotor_inertia.cwiseProduct(state_.acceleration);
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        if (soft(i)) {
            load_[i] = gear_torque(i, position_, velocity_);
        }
    }
}

Wrench SimulatedArm::wrench() const {
    Wrench wrench = dynamics_.wrench(configuration_, velocity_, acceleration_);
    const Eigen::Vector3d force = loads_.tip_force(time_s_);
    if (!force.isZero(0)) {
        wrench += dynamics_.wrench_of_force(configuration_, dynamics_.tip(configuration_), force);
    }
    for (const Push& push : faults_ ? faults_->pushes : std::vector<Push>()) {
        const bool beyond =
            !push.link || pushed_link(push) >= static_cast<Eigen::Index>(dynamics_.robot().sensor->link);
        if (beyond) {
            wrench +=
                dynamics_.wrench_of_force(configuration_, pushed_point(push, configuration_), push.force);
        }
    }
    return wrench;
}

void SimulatedArm::advance(double duration) {
    move_bristles(duration / 2);
    const Instant begin = instant(0);
    const Instant middle = instant(duration / 2);
    const Instant end = instant(duration);
    const JointVector q = position_;
    const JointVector v1 = velocity_;
    const JointVector a1 = dynamics_.forward(configuration_, v1, forces(configuration_, q, v1, begin));
    const JointVector v2 = v1 + duration / 2 * a1;
    const JointVector a2 = acceleration_at(q + duration / 2 * v1, v2, middle);
    const JointVector v3 = v1 + duration / 2 * a2;
    const JointVector a3 = acceleration_at(q + duration / 2 * v2, v3, middle);
    const JointVector v4 = v1 + duration * a3;
    const JointVector a4 = acceleration_at(q + duration * v3, v4, end);
    position_ = q + duration / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    velocity_ = v1 + duration / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    time_s_ = end.time_s;
    state_.torque = end.torque;
    move_bristles(duration / 2);
    complete();
}

} // namespace dfdyn::tools
