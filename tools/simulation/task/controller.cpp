// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/controller.hpp"

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/random_streams.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

Robot mistaken(Robot robot, double mass_error, std::uint64_t seed) {
    NormalSource source(seed, stream::controller_model);
    for (RobotJoint& joint : robot.joints) {
        joint.inertia *= std::max(0.1, 1 + mass_error * source.next());
    }
    return robot;
}

} // namespace

Controller::Controller(const Robot& robot, const JointVector& rotor_inertia, const ControllerModel& model,
                       std::uint64_t seed)
    : model_(model), dynamics_(mistaken(robot, model.mass_error, seed), rotor_inertia) {}

JointVector Controller::torque(const Reference& reference, const JointVector& position,
                               const JointVector& velocity) {
    const bool ahead = model_.kind == ControllerKind::feed_forward;
    dynamics_.configure(ahead ? reference.position : position, configuration_);
    const JointVector correction = model_.position_gain.cwiseProduct(reference.position - position) +
                                   model_.velocity_gain.cwiseProduct(reference.velocity - velocity);
    if (model_.kind == ControllerKind::computed_torque) {
        return dynamics_.inverse(configuration_, velocity, reference.acceleration + correction);
    }
    if (ahead) {
        return dynamics_.inverse(configuration_, reference.velocity, reference.acceleration) + correction;
    }
    const JointVector at_rest = JointVector::Zero(position.size());
    return dynamics_.inverse(configuration_, at_rest, at_rest) + correction;
}

} // namespace dfdyn::tools
