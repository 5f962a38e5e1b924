// SPDX-License-Identifier: Apache-2.0
#include "tools/physics/machine_size.hpp"

#include "tools/common/error.hpp"
#include "tools/common/number.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace dfdyn::tools {

namespace {

constexpr double gravity = 9.81;
constexpr double placeholder_efforts = 100;  ///< times m g r
constexpr double placeholder_velocity = 100; ///< rad/s, m/s
constexpr double shortest_reach = 0.01;
constexpr double unknown_mass = 1000;

double travel(const RobotJoint& joint) {
    return joint.prismatic && joint.lower ? std::max(std::abs(*joint.lower), std::abs(*joint.upper)) : 0;
}

double centre_distance(const RobotJoint& joint) {
    const double mass = joint.inertia[0];
    return mass > 0 ? joint.inertia.segment<3>(1).norm() / mass : 0;
}

double reach_of(const Robot& robot) {
    double to_joint = 0;
    double reach = shortest_reach;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        to_joint +=
            travel(joint) + (i > 0 ? joint.placement.translation().norm() : 0); // not the base's height
        reach = std::max(reach, to_joint + centre_distance(joint));
    }
    return std::max(reach, to_joint + robot.tip_placement.translation().norm());
}

double mass_of(const Robot& robot, double reach) {
    double mass = 0;
    double effort = 0;
    for (const RobotJoint& joint : robot.joints) {
        mass += std::max(joint.inertia[0], 0.0);
        effort = std::max(effort, joint.effort.value_or(0));
    }
    if (mass > 0) {
        return mass;
    }
    return effort > 0 ? effort / (gravity * reach) : unknown_mass;
}

/// Mass and reach of a robot, and what follows from them.
struct MachineSize {
    double reach, mass;

    explicit MachineSize(const Robot& robot) : reach(reach_of(robot)), mass(mass_of(robot, reach)) {}

    double weight() const { return mass * gravity; }

    double torque(const RobotJoint& joint) const {
        const double own = joint.prismatic ? weight() : weight() * reach;
        const double effort = joint.effort.value_or(0);
        return effort < placeholder_efforts * own ? std::max(effort, own) : own;
    }

    static double velocity(const RobotJoint& joint) {
        const double limit = joint.velocity.value_or(0);
        return limit > 0 && limit < placeholder_velocity ? limit : 1;
    }

    double effect(const EffectModel& effect, const Robot& robot) const {
        if (effect.name == "ft_bias") {
            return effect.row < 3 ? weight() : weight() * reach;
        }
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(effect.row)];
        if (effect.name == "rotor_inertia") {
            return joint.prismatic ? mass : mass * reach * reach;
        }
        return effect.name == "viscous_friction" ? torque(joint) / velocity(joint) : torque(joint);
    }
};

} // namespace

Eigen::VectorXd parameter_sizes(const Robot& robot, const ChainModel& chain,
                                const std::vector<EffectModel>& effects) {
    const MachineSize machine(robot);
    const int bodies = body_count(robot, chain.sensor ? OutputKind::wrench : OutputKind::joint_torque);
    Eigen::VectorXd sizes(inertial_parameters * bodies + static_cast<Eigen::Index>(effects.size()));
    InertialParameters body;
    body << machine.mass, Eigen::Vector3d::Constant(machine.mass * machine.reach),
        Eigen::Matrix<double, 6, 1>::Constant(machine.mass * machine.reach * machine.reach);
    sizes.head(inertial_parameters * bodies) = body.replicate(bodies, 1);
    for (std::size_t i = 0; i < effects.size(); ++i) {
        sizes[inertial_parameters * bodies + static_cast<Eigen::Index>(i)] =
            machine.effect(effects[i], robot);
    }
    return sizes;
}

void check_parameters(const PhysicsModel& physics, const Eigen::VectorXd& sizes) {
    for (std::size_t i = 0; i < physics.selected.size(); ++i) {
        const double value = physics.column_scale[i] * physics.start.weights[i];
        const double bound = parameter_margin * sizes[physics.selected[i]];
        if (!(std::abs(value) <= bound)) {
            throw InputError("trained physics: parameter " + physics.parameter_names[i] +
                             ": expected at most " + rounded_text(bound) +
                             " in magnitude for a robot of this mass, reach and effort, "
                             "found " +
                             rounded_text(value) + "; check robot, units and signs, or record more motion");
        }
    }
}

} // namespace dfdyn::tools
