// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/parameter_sizes.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/effects.hpp"
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
constexpr double link_share = 0.3;  ///< of known masses: error of a robot's file, one standard deviation
constexpr double tool_share = 0.05; ///< of the robot's mass and reach: a tool that the file lacks

double travel(const RobotJoint& joint) {
    return joint.prismatic && joint.lower ? std::max(std::abs(*joint.lower), std::abs(*joint.upper)) : 0;
}

double centre_distance(const RobotJoint& joint) {
    const double mass = joint.inertia[0];
    return mass > 0 ? joint.inertia.segment<3>(1).norm() / mass : 0;
}

/// Distance from joint `first` to the tip or the farthest centre of mass.
double reach_of(const Robot& robot, std::size_t first) {
    double to_joint = 0;
    double reach = shortest_reach;
    for (std::size_t i = first; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        // without the base's height
        to_joint += travel(joint) + (i > first ? joint.placement.translation().norm() : 0);
        reach = std::max(reach, to_joint + centre_distance(joint));
    }
    return std::max(reach, to_joint + robot.tip_placement.translation().norm());
}

/// Sum of the file's masses of joint `first` and everything beyond it.
double known_mass(const Robot& robot, std::size_t first) {
    double mass = 0;
    for (std::size_t i = first; i < robot.joints.size(); ++i) {
        mass += std::max(robot.joints[i].inertia[0], 0.0);
    }
    return mass;
}

/// Mass of joint `first` and everything beyond it. Where the file has none, it is not more than that of the
/// whole robot.
double mass_of(const Robot& robot, std::size_t first, double reach) {
    const double mass = known_mass(robot, first);
    if (mass > 0) {
        return mass;
    }
    double effort = 0;
    for (std::size_t i = first; i < robot.joints.size(); ++i) {
        effort = std::max(effort, robot.joints[i].effort.value_or(0));
    }
    const double whole = known_mass(robot, 0);
    const double possible = effort > 0 ? effort / (gravity * reach) : unknown_mass;
    return whole > 0 ? std::min(possible, whole) : possible;
}

/// Sizes of the parameters of a body with this mass, whose farthest point is at `reach`.
InertialParameters body_of(double mass, double reach) {
    InertialParameters sizes;
    sizes << mass, Eigen::Vector3d::Constant(mass * reach),
        Eigen::Matrix<double, 6, 1>::Constant(mass * reach * reach);
    return sizes;
}

/// Mass and reach of a robot from one of its joints on, and quantities derived from them.
struct MachineSize {
    double reach, mass;

    explicit MachineSize(const Robot& robot, std::size_t first = 0)
        : reach(reach_of(robot, first)), mass(mass_of(robot, first, reach)) {}

    InertialParameters body() const { return body_of(mass, reach); }

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
        const ParameterSize size = effect_kind(effect.name).size;
        if (size == ParameterSize::weight) {
            return effect.row < 3 ? weight() : weight() * reach;
        }
        const RobotJoint& joint = robot.joints[static_cast<std::size_t>(effect.row)];
        if (size == ParameterSize::inertia) {
            return joint.prismatic ? mass : mass * reach * reach;
        }
        return size == ParameterSize::effort_per_velocity ? torque(joint) / velocity(joint) : torque(joint);
    }
};

/// Prior standard deviations of the parameters of a joint's link. The last link may carry a tool.
InertialParameters link_deviations(const Robot& robot, std::size_t joint) {
    const MachineSize beyond(robot, joint);
    const InertialParameters own = (known_mass(robot, joint) > 0 ? link_share : 1) * beyond.body();
    if (joint + 1 < robot.joints.size()) {
        return own;
    }
    const MachineSize machine(robot);
    return own + body_of(tool_share * machine.mass, beyond.reach + tool_share * machine.reach);
}

OutputKind outputs_of(const ChainModel& chain) {
    return chain.sensor ? OutputKind::wrench : OutputKind::joint_torque;
}

} // namespace

Eigen::VectorXd parameter_sizes(const Robot& robot, const ChainModel& chain,
                                const std::vector<EffectModel>& effects) {
    const MachineSize machine(robot);
    const int bodies = body_count(robot, outputs_of(chain));
    Eigen::VectorXd sizes(inertial_parameters * bodies + static_cast<Eigen::Index>(effects.size()));
    sizes.head(inertial_parameters * bodies) = machine.body().replicate(bodies, 1);
    for (std::size_t i = 0; i < effects.size(); ++i) {
        sizes[inertial_parameters * bodies + static_cast<Eigen::Index>(i)] =
            machine.effect(effects[i], robot);
    }
    return sizes;
}

Eigen::VectorXd expected_parameters(const Robot& robot, const ChainModel& chain,
                                    const std::vector<EffectModel>& effects) {
    const Eigen::VectorXd nominal = nominal_parameters(robot, outputs_of(chain));
    Eigen::VectorXd expected =
        Eigen::VectorXd::Zero(nominal.size() + static_cast<Eigen::Index>(effects.size()));
    expected.head(nominal.size()) = nominal;
    return expected;
}

Eigen::VectorXd parameter_deviations(const Robot& robot, const ChainModel& chain,
                                     const std::vector<EffectModel>& effects) {
    Eigen::VectorXd deviations = parameter_sizes(robot, chain, effects);
    const auto bodies = static_cast<std::size_t>(body_count(robot, outputs_of(chain)));
    const std::size_t joints = robot.joints.size();
    for (std::size_t body = 0; body < bodies; ++body) {
        deviations.segment<inertial_parameters>(inertial_parameters * static_cast<Eigen::Index>(body)) =
            link_deviations(robot, joints - std::min(joints, bodies - body));
    }
    auto effect = deviations.end() - static_cast<Eigen::Index>(effects.size());
    for (const EffectModel& one : effects) {
        *effect++ *= effect_kind(one.name).expected_share;
    }
    return deviations;
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
