// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include "tools/base/text/error.hpp"

#include <Eigen/Cholesky>

#include <array>
#include <string>
#include <utility>

namespace dfdyn::tools {

namespace {

void check(const Robot& robot) {
    if (robot.joints.empty() || robot.joints.size() > largest_simulated_chain) {
        throw InputError("robot " + robot.name + ": expected a chain of 1 to " +
                         std::to_string(largest_simulated_chain) + " joints, found " +
                         std::to_string(robot.joints.size()));
    }
    for (const RobotJoint& joint : robot.joints) {
        if (!(joint.inertia[0] >= 0)) {
            throw InputError("robot " + robot.name + ": link " + joint.link +
                             ": expected a mass that is not negative, found " +
                             std::to_string(joint.inertia[0]));
        }
    }
}

Eigen::Isometry3d placed_at(const RobotJoint& joint, double position) {
    Eigen::Isometry3d result = joint.placement;
    if (joint.prismatic) {
        result.translate(position * joint.axis);
    } else {
        result.rotate(Eigen::AngleAxisd(position, joint.axis));
    }
    return result;
}

} // namespace

ArmDynamics::ArmDynamics(Robot robot, JointVector rotor_inertia)
    : robot_(std::move(robot)), rotor_inertia_(std::move(rotor_inertia)) {
    check(robot_);
}

void ArmDynamics::configure(const JointVector& position, Configuration& configuration) const {
    const std::size_t count = robot_.joints.size();
    configuration.axis.resize(count);
    configuration.inertia.resize(count);
    configuration.place.resize(count);
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < count; ++i) {
        const RobotJoint& joint = robot_.joints[i];
        place = place * placed_at(joint, position[static_cast<Eigen::Index>(i)]);
        const Eigen::Vector3d axis = place.linear() * joint.axis;
        if (joint.prismatic) {
            configuration.axis[i] = {Eigen::Vector3d::Zero(), axis};
        } else {
            configuration.axis[i] = {axis, place.translation().cross(axis)};
        }
        configuration.place[i] = place;
        configuration.inertia[i] = at_base(joint.inertia, place);
    }
}

/// Gravity, represented as an acceleration of the base.
ArmDynamics::LinkMotion ArmDynamics::base_motion() const {
    return {{}, {Eigen::Vector3d::Zero(), -robot_.gravity}};
}

ArmDynamics::LinkMotion ArmDynamics::step(const Configuration& configuration, std::size_t joint,
                                          const LinkMotion& previous, double velocity,
                                          double acceleration) const {
    const SpatialMotion along = configuration.axis[joint] * velocity;
    return {previous.velocity + along, previous.acceleration + configuration.axis[joint] * acceleration +
                                           previous.velocity.cross(along)};
}

SpatialForce ArmDynamics::net_force(const SpatialInertia& inertia, const LinkMotion& motion) const {
    return inertia * motion.acceleration + (inertia * motion.velocity).moved_by(motion.velocity);
}

JointVector ArmDynamics::inverse(const Configuration& configuration, const JointVector& velocity,
                                 const JointVector& acceleration) const {
    const std::size_t count = robot_.joints.size();
    std::array<SpatialForce, largest_simulated_chain> force;
    LinkMotion motion = base_motion();
    for (std::size_t i = 0; i < count; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        motion = step(configuration, i, motion, velocity[k], acceleration[k]);
        force[i] = net_force(configuration.inertia[i], motion);
    }
    JointVector torque = rotor_inertia_.cwiseProduct(acceleration);
    SpatialForce beyond;
    for (std::size_t i = count; i-- > 0;) {
        beyond = beyond + force[i];
        torque[static_cast<Eigen::Index>(i)] += beyond.power(configuration.axis[i]);
    }
    return torque;
}

JointMatrix ArmDynamics::mass_matrix(const Configuration& configuration) const {
    const auto count = static_cast<Eigen::Index>(robot_.joints.size());
    JointMatrix result = JointMatrix::Zero(count, count);
    result.diagonal() = rotor_inertia_;
    SpatialInertia beyond;
    for (Eigen::Index i = count; i-- > 0;) {
        const auto k = static_cast<std::size_t>(i);
        beyond = beyond + configuration.inertia[k];
        const SpatialForce force = beyond * configuration.axis[k];
        result(i, i) += force.power(configuration.axis[k]);
        for (Eigen::Index j = 0; j < i; ++j) {
            result(i, j) = force.power(configuration.axis[static_cast<std::size_t>(j)]);
            result(j, i) = result(i, j);
        }
    }
    return result;
}

JointVector ArmDynamics::forward(const Configuration& configuration, const JointVector& velocity,
                                 const JointVector& torque) const {
    const JointVector at_rest = JointVector::Zero(velocity.size());
    const JointVector bias = inverse(configuration, velocity, at_rest);
    return mass_matrix(configuration).llt().solve(torque - bias);
}

Wrench ArmDynamics::wrench(const Configuration& configuration, const JointVector& velocity,
                           const JointVector& acceleration) const {
    const ForceTorqueSensor& sensor = *robot_.sensor;
    LinkMotion motion = base_motion();
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    SpatialForce force;
    for (std::size_t i = 0; i <= robot_.joints.size(); ++i) {
        if (i > 0) {
            const auto k = static_cast<Eigen::Index>(i - 1);
            motion = step(configuration, i - 1, motion, velocity[k], acceleration[k]);
        }
        if (i == sensor.link) {
            place = (i == 0 ? Eigen::Isometry3d::Identity() : configuration.place[i - 1]);
            force = net_force(at_base(sensor.inertia_beyond, place), motion);
        } else if (i > sensor.link) {
            force = force + net_force(configuration.inertia[i - 1], motion);
        }
    }
    return at_sensor(force, place);
}

Wrench ArmDynamics::at_sensor(const SpatialForce& beyond, const Eigen::Isometry3d& sensor_link) const {
    const Eigen::Isometry3d frame = sensor_link * robot_.sensor->placement;
    const Eigen::Vector3d torque = beyond.torque - frame.translation().cross(beyond.force);
    Wrench result;
    result << frame.linear().transpose() * beyond.force, frame.linear().transpose() * torque;
    return robot_.sensor->parent_to_child ? result : -result;
}

Wrench ArmDynamics::wrench_of_force(const Configuration& configuration, const Eigen::Vector3d& point,
                                    const Eigen::Vector3d& force) const {
    const std::size_t link = robot_.sensor->link;
    // the external force reduces the load on the base's side
    const SpatialForce spared{point.cross(-force), -force};
    return at_sensor(spared, link == 0 ? Eigen::Isometry3d::Identity() : configuration.place[link - 1]);
}

double ArmDynamics::energy(const Configuration& configuration, const JointVector& velocity) const {
    double potential = 0;
    for (const SpatialInertia& link : configuration.inertia) {
        potential -= robot_.gravity.dot(link.moment);
    }
    return 0.5 * velocity.dot(mass_matrix(configuration) * velocity) + potential;
}

Eigen::Vector3d ArmDynamics::tip(const Configuration& configuration) const {
    return configuration.place.back() * robot_.tip_placement.translation();
}

PointJacobian ArmDynamics::tip_jacobian(const Configuration& configuration) const {
    return point_jacobian(configuration, joint_count() - 1, tip(configuration));
}

PointJacobian ArmDynamics::point_jacobian(const Configuration& configuration, Eigen::Index link,
                                          const Eigen::Vector3d& point) const {
    PointJacobian result = PointJacobian::Zero(3, joint_count());
    for (Eigen::Index i = 0; i <= link; ++i) {
        const SpatialMotion& axis = configuration.axis[static_cast<std::size_t>(i)];
        result.col(i) = axis.linear + axis.angular.cross(point);
    }
    return result;
}

} // namespace dfdyn::tools
