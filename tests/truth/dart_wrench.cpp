// SPDX-License-Identifier: Apache-2.0
#include "tests/truth/dart_wrench.hpp"

#include "tests/support/random_robot.hpp"

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>

namespace dfdyn::tests {

namespace {

using dart::dynamics::BodyNode;
using dart::dynamics::Skeleton;

dart::dynamics::Inertia dart_inertia(const Body& body) {
    return {body.mass, body.centre, body.central_inertia};
}

/// The same body, described in a frame that is at `placement` in its own.
Body seen_from(const Eigen::Isometry3d& placement, const Body& body) {
    const Eigen::Matrix3d rotation = placement.linear();
    return {body.mass, placement.inverse() * body.centre,
            rotation.transpose() * body.central_inertia * rotation};
}

/// Adds a joint with unique names, because DART prints a line for every repeated name.
template <class Joint>
std::pair<Joint*, BodyNode*> add_named(Skeleton& skeleton, BodyNode* parent, const std::string& name) {
    typename Joint::Properties joint;
    joint.mName = name;
    return skeleton.createJointAndBodyNodePair<Joint>(parent, joint, BodyNode::AspectProperties(name));
}

template <class Joint>
BodyNode* add_moving(Skeleton& skeleton, BodyNode* parent, const tools::RobotJoint& joint,
                     const Eigen::Isometry3d& placement) {
    const auto [moving, body] = add_named<Joint>(skeleton, parent, joint.name);
    moving->setAxis(joint.axis);
    moving->setTransformFromParentBodyNode(placement);
    body->setInertia(dart_inertia(body_of(joint.inertia)));
    return body;
}

BodyNode* add_sensor(Skeleton& skeleton, BodyNode* parent, const tools::ForceTorqueSensor& sensor) {
    const auto [fixed, body] = add_named<dart::dynamics::WeldJoint>(skeleton, parent, "sensor");
    fixed->setTransformFromParentBodyNode(sensor.placement);
    body->setInertia(dart_inertia(seen_from(sensor.placement, body_of(sensor.inertia_beyond))));
    return body;
}

/// Builds a skeleton in which the link that carries the sensor consists of two bodies, welded at the sensor.
/// Returns the body whose joint transmits the sensor's wrench.
BodyNode* build(Skeleton& skeleton, const tools::Robot& robot) {
    BodyNode* measured = nullptr;
    BodyNode* parent = nullptr;
    Eigen::Isometry3d link_in_parent = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const tools::RobotJoint& joint = robot.joints[i];
        const Eigen::Isometry3d placement = link_in_parent * joint.placement;
        parent = joint.prismatic
                     ? add_moving<dart::dynamics::PrismaticJoint>(skeleton, parent, joint, placement)
                     : add_moving<dart::dynamics::RevoluteJoint>(skeleton, parent, joint, placement);
        link_in_parent.setIdentity();
        if (robot.sensor->link == i + 1) {
            measured = parent = add_sensor(skeleton, parent, *robot.sensor);
            link_in_parent = robot.sensor->placement.inverse();
        }
    }
    return measured == nullptr ? skeleton.getBodyNode(0) : measured;
}

} // namespace

Wrench dart_wrench(const tools::Robot& robot, const Eigen::VectorXd& xi) {
    const dart::dynamics::SkeletonPtr skeleton = Skeleton::create();
    const BodyNode* const body = build(*skeleton, robot);
    skeleton->setGravity(robot.gravity);
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const auto first = static_cast<Eigen::Index>(3 * i);
        skeleton->setPosition(i, xi[first]);
        skeleton->setVelocity(i, xi[first + 1]);
        skeleton->setAcceleration(i, xi[first + 2]);
    }
    skeleton->computeInverseDynamics();
    const Eigen::Isometry3d sensor = robot.sensor->link == 0
                                         ? robot.sensor->placement.inverse() * body->getWorldTransform()
                                         : Eigen::Isometry3d::Identity(); // of the body in the sensor's frame
    const Eigen::Vector3d force = sensor.linear() * body->getBodyForce().tail<3>();
    const Eigen::Vector3d torque = sensor.linear() * body->getBodyForce().head<3>();
    Wrench wrench;
    wrench << force, torque + sensor.translation().cross(force);
    return wrench;
}

Eigen::VectorXd dart_acceleration(const tools::Robot& robot, const Eigen::VectorXd& position,
                                  const Eigen::VectorXd& velocity, const Eigen::VectorXd& torque) {
    const dart::dynamics::SkeletonPtr skeleton = Skeleton::create();
    build(*skeleton, robot);
    skeleton->setGravity(robot.gravity);
    const auto joints = static_cast<std::size_t>(position.size());
    for (std::size_t i = 0; i < joints; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        skeleton->setPosition(i, position[k]);
        skeleton->setVelocity(i, velocity[k]);
        skeleton->setForce(i, torque[k]);
    }
    skeleton->computeForwardDynamics();
    Eigen::VectorXd acceleration(position.size());
    for (std::size_t i = 0; i < joints; ++i) {
        acceleration[static_cast<Eigen::Index>(i)] = skeleton->getAcceleration(i);
    }
    return acceleration;
}

} // namespace dfdyn::tests
