// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/simulated_arm.hpp"

#include <utility>

namespace dfdyn::tools {

SimulatedArm::SimulatedArm(const Robot& robot, const ActuatorModel& actuators, const JointVector& position)
    : dynamics_(robot, actuators.rotor_inertia), actuators_(actuators) {
    for (const LuGreParameters& parameters : actuators.friction) {
        friction_.emplace_back(parameters);
    }
    state_.position = position;
    state_.velocity = JointVector::Zero(position.size());
    state_.torque = state_.velocity;
    complete();
}

void SimulatedArm::attach(const InertialParameters& body) {
    Robot robot = dynamics_.robot();
    robot.joints.back().inertia += body;
    dynamics_ = ArmDynamics(std::move(robot), actuators_.rotor_inertia);
    complete();
}

void SimulatedArm::apply(const JointVector& command) {
    state_.torque = command;
    if (actuators_.torque_limit) {
        state_.torque = command.cwiseMin(*actuators_.torque_limit).cwiseMax(-*actuators_.torque_limit);
    }
    state_.acceleration = dynamics_.forward(configuration_, state_.velocity, state_.torque - state_.friction);
}

JointVector SimulatedArm::friction_at(const JointVector& velocity) const {
    JointVector result(velocity.size());
    for (Eigen::Index i = 0; i < velocity.size(); ++i) {
        result[i] = friction_[static_cast<std::size_t>(i)].torque(velocity[i]);
    }
    return result;
}

JointVector SimulatedArm::acceleration_at(const JointVector& position, const JointVector& velocity) {
    dynamics_.configure(position, stage_);
    return dynamics_.forward(stage_, velocity, state_.torque - friction_at(velocity));
}

void SimulatedArm::move_bristles(double duration) {
    for (Eigen::Index i = 0; i < state_.velocity.size(); ++i) {
        friction_[static_cast<std::size_t>(i)].advance(state_.velocity[i], duration);
    }
}

void SimulatedArm::complete() {
    dynamics_.configure(state_.position, configuration_);
    state_.friction = friction_at(state_.velocity);
    state_.acceleration = dynamics_.forward(configuration_, state_.velocity, state_.torque - state_.friction);
}

void SimulatedArm::advance(double duration) {
    move_bristles(duration / 2);
    const JointVector q = state_.position;
    const JointVector v1 = state_.velocity;
    const JointVector a1 = dynamics_.forward(configuration_, v1, state_.torque - friction_at(v1));
    const JointVector v2 = v1 + duration / 2 * a1;
    const JointVector a2 = acceleration_at(q + duration / 2 * v1, v2);
    const JointVector v3 = v1 + duration / 2 * a2;
    const JointVector a3 = acceleration_at(q + duration / 2 * v2, v3);
    const JointVector v4 = v1 + duration * a3;
    const JointVector a4 = acceleration_at(q + duration * v3, v4);
    state_.position = q + duration / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    state_.velocity = v1 + duration / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    move_bristles(duration / 2);
    complete();
}

} // namespace dfdyn::tools
