// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulated_arm.hpp"

#include "tools/common/error.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

/// Rotors that move with their links; those of soft joints move on their own.
JointVector rigid_rotors(const ActuatorModel& actuators) {
    JointVector result = actuators.rotor_inertia;
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        if (actuators.gear.soft(i)) {
            result[i] = 0;
        }
    }
    return result;
}

} // namespace

SimulatedArm::SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position,
                           const JointLoads& loads)
    : dynamics_(robot, rigid_rotors(actuators)), actuators_(actuators), loads_(loads), position_(position) {
    for (const LuGreParameters& parameters : actuators.friction) {
        friction_.emplace_back(parameters);
    }
    add_motors();
    velocity_ = JointVector::Zero(position_.size());
    state_.torque = command_ = load_ = JointVector::Zero(position.size());
    complete();
}

void SimulatedArm::add_motors() {
    for (Eigen::Index i = 0; i < joint_count(); ++i) {
        motor_.push_back(i);
        if (!actuators_.gear.soft(i)) {
            continue;
        }
        const Eigen::Index coordinate = position_.size();
        if (coordinate == largest_simulated_chain || !(actuators_.rotor_inertia[i] > 0)) {
            throw InputError("joint " + std::to_string(i + 1) +
                             ": expected a soft joint to have a rotor, and at most " +
                             std::to_string(largest_simulated_chain) + " joints and motors of soft joints");
        }
        motor_.back() = coordinate;
        position_.conservativeResize(coordinate + 1);
        position_[coordinate] = position_[i];
    }
}

void SimulatedArm::attach(const InertialParameters& body) {
    Robot robot = dynamics_.robot();
    robot.joints.back().inertia += body;
    if (robot.sensor && robot.sensor->link == robot.joints.size()) {
        robot.sensor->inertia_beyond += body;
    }
    dynamics_ = ArmDynamics(std::move(robot), rigid_rotors(actuators_));
    complete();
}

void SimulatedArm::apply(const JointVector& command) {
    command_ = command;
    if (actuators_.torque_limit) {
        command_ = command.cwiseMin(*actuators_.torque_limit).cwiseMax(-*actuators_.torque_limit);
    }
    if (actuators_.bandwidth_hz > 0 && commanded_) {
        return; // the torque follows
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

JointVector SimulatedArm::friction_at(const JointVector& velocity) const {
    JointVector result(joint_count());
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        result[i] = friction_[k].torque(velocity[motor_[k]]);
    }
    return result;
}

JointVector SimulatedArm::acceleration_at(const ArmDynamics::Configuration& configuration,
                                          const JointVector& position, const JointVector& velocity,
                                          const Instant& instant) const {
    const Eigen::Index joints = joint_count();
    JointVector torque = instant.torque - friction_at(velocity);
    JointVector acceleration(position.size());
    for (Eigen::Index i = 0; i < joints; ++i) {
        const Eigen::Index motor = motor_[static_cast<std::size_t>(i)];
        if (motor != i) {
            const double passed =
                actuators_.gear.torque(i, position[motor] - position[i], velocity[motor] - velocity[i]);
            acceleration[motor] = (torque[i] - passed) / actuators_.rotor_inertia[i];
            torque[i] = passed;
        }
    }
    if (!loads_.none()) {
        torque += loads_.torque(position.head(joints), velocity.head(joints), instant.time_s);
        const Eigen::Vector3d force = loads_.tip_force(instant.time_s);
        if (!force.isZero(0)) {
            torque += dynamics_.tip_jacobian(configuration).transpose() * force;
        }
    }
    acceleration.head(joints) = dynamics_.forward(configuration, velocity.head(joints), torque);
    return acceleration;
}

JointVector SimulatedArm::acceleration_at(const JointVector& position, const JointVector& velocity,
                                          const Instant& instant) {
    dynamics_.configure(position, stage_);
    return acceleration_at(stage_, position, velocity, instant);
}

void SimulatedArm::move_bristles(double duration) {
    for (std::size_t i = 0; i < friction_.size(); ++i) {
        friction_[i].advance(velocity_[motor_[i]], duration);
    }
}

void SimulatedArm::accelerate() {
    const Eigen::Index joints = joint_count();
    const JointVector acceleration = acceleration_at(configuration_, position_, velocity_, instant(0));
    state_.acceleration = acceleration.head(joints);
    for (Eigen::Index i = 0; i < joints; ++i) {
        state_.motor_acceleration[i] = acceleration[motor_[static_cast<std::size_t>(i)]];
    }
}

void SimulatedArm::complete() {
    const Eigen::Index joints = joint_count();
    dynamics_.configure(position_, configuration_);
    state_.position = position_.head(joints);
    state_.velocity = velocity_.head(joints);
    for (Eigen::Index i = 0; i < joints; ++i) {
        friction_[static_cast<std::size_t>(i)].set_conditions(time_s_, load_[i]);
    }
    state_.friction = friction_at(velocity_);
    state_.motor_position = state_.motor_velocity = state_.motor_acceleration = state_.position;
    for (Eigen::Index i = 0; i < joints; ++i) {
        state_.motor_position[i] = position_[motor_[static_cast<std::size_t>(i)]];
        state_.motor_velocity[i] = velocity_[motor_[static_cast<std::size_t>(i)]];
    }
    accelerate();
    load_ =
        state_.torque - state_.friction - actuators_.rotor_inertia.cwiseProduct(state_.motor_acceleration);
}

Wrench SimulatedArm::wrench() const {
    const Wrench rigid = dynamics_.wrench(configuration_, state_.velocity, state_.acceleration);
    const Eigen::Vector3d force = loads_.tip_force(time_s_);
    return force.isZero(0) ? rigid : Wrench(rigid + dynamics_.wrench_of_tip_force(configuration_, force));
}

void SimulatedArm::advance(double duration) {
    move_bristles(duration / 2);
    const Instant begin = instant(0);
    const Instant middle = instant(duration / 2);
    const Instant end = instant(duration);
    const JointVector q = position_;
    const JointVector v1 = velocity_;
    const JointVector a1 = acceleration_at(configuration_, q, v1, begin);
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
